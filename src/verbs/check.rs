//! `fabc check`: reports what is wrong with files, and the most model calls that a task can make.

mod fix;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::{shipped, sources, watch};
use clap::{Args, ValueHint};
use fab_base::wording::counted;
use fab_compiler::Compiled;
use fab_compiler::diag::{self, Severity};
use fab_program::spaces::Spaces;
use fab_program::{Material, Program};
use fix::Effect;
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

#[derive(Args)]
pub struct CheckArguments {
    /// The files to check, or names of shipped tasks.
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub files: Vec<String>,
    /// Apply the corrections that are certain to these files; report the rest.
    #[arg(long)]
    pub fix: bool,
    /// With `--fix`: show the changes as a unified diff and write nothing.
    #[arg(long, requires = "fix")]
    pub diff: bool,
    /// Exit with code 1 if there is a warning.
    #[arg(long)]
    pub deny_warnings: bool,
    /// Run again whenever a file that was read changes, until Ctrl-C.
    #[arg(long, conflicts_with = "json")]
    pub watch: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

pub fn run(arguments: &CheckArguments, io: &Io) -> Result<Exit, Failure> {
    let check = || check(arguments, io);
    watch::run(arguments.watch, &arguments.files, &[], check, io)
}

#[derive(Default, Serialize)]
struct Checked {
    diagnostics: Vec<Value>,
    diagnostics_left_out: usize,
    tasks: Vec<CheckedTask>,
    errors: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    diff: Option<String>,
    #[serde(skip)]
    n_warnings: usize,
    #[serde(skip)]
    has_errors: bool,
}

#[derive(Serialize)]
struct CheckedTask {
    task: String,
    variant: Option<String>,
    file: String,
    program: String,
    horizon: u32,
    max_calls_per_step: u32,
    max_calls: u64,
    spaces: Spaces,
    #[serde(skip_serializing_if = "Option::is_none")]
    about: Option<String>,
    /// Set if the steps of its demonstration have not been judged.
    demonstration: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    material: Option<String>,
    /// How the simulated cloth differs from its material; `None` if it cannot be laid.
    #[serde(skip_serializing_if = "Option::is_none")]
    simulated: Option<Vec<String>>,
}

/// Checks every file; one file's faults do not stop the others.
fn check(arguments: &CheckArguments, io: &Io) -> Result<Exit, Failure> {
    let mut checked = Checked::default();
    let found = arguments.files.iter().map(|file| shipped::find(file, io));
    let mut found: Vec<Result<String, Failure>> = found.collect();
    // A file may use one that is named after it, so all are fixed before any is reported.
    if arguments.diff {
        let diff = checked.diff.insert(fix::run(&mut found, Effect::Show, io));
        if !arguments.json && !diff.is_empty() {
            io.data(diff.trim_end_matches('\n'));
        }
    } else if arguments.fix {
        fix::run(&mut found, Effect::Write, io);
    }
    for (file, found) in arguments.files.iter().zip(found) {
        let compiled = found.and_then(|found| {
            let beside = sources::folder_of(&found);
            Ok((sources::compile_looking(&found)?, beside))
        });
        match compiled {
            Ok((compiled, beside)) => {
                let tasks = checked.add(file, &compiled, &beside);
                if !arguments.json {
                    report(file, &compiled, tasks, io);
                }
            }
            Err(failure) => {
                io.talk(&format!("error: {failure}"));
                checked.errors.push(failure.to_string());
            }
        }
    }
    if arguments.json {
        io.json(&checked);
    }
    if !checked.errors.is_empty() {
        return Ok(Exit::Environment);
    }
    if checked.has_errors {
        return Ok(Exit::Author);
    }
    if arguments.deny_warnings && checked.n_warnings > 0 {
        let count = counted(checked.n_warnings, "warning");
        io.talk(&format!(
            "error: {count}, and `--deny-warnings` allows none"
        ));
        return Ok(Exit::Author);
    }
    Ok(Exit::Done)
}

impl Checked {
    /// Adds what was found in a file; returns its tasks.
    fn add(&mut self, file: &str, compiled: &Compiled, beside: &Path) -> &[CheckedTask] {
        let severities = compiled.diagnostics.iter().map(|it| it.severity);
        self.n_warnings += severities.filter(|it| *it == Severity::Warning).count();
        self.has_errors |= compiled.has_errors();
        self.diagnostics_left_out += compiled.left_out;
        if let Value::Array(found) = diag::to_json(&compiled.diagnostics, &compiled.sources) {
            self.diagnostics.extend(found);
        }
        let earlier = self.tasks.len();
        let tasks = compiled.programs.iter();
        self.tasks
            .extend(tasks.map(|program| CheckedTask::of(program, file, beside)));
        &self.tasks[earlier..]
    }
}

fn report(file: &str, compiled: &Compiled, tasks: &[CheckedTask], io: &Io) {
    if !compiled.diagnostics.is_empty() {
        io.painted_data(&sources::findings(compiled, io.data_color()));
    }
    let file = diag::visible(file);
    // Each task is followed by its variants.
    for tasks in tasks.chunk_by(|_, next| next.variant.is_some()) {
        let [task, variants @ ..] = tasks else {
            continue;
        };
        let variants = variants.iter().filter_map(|it| it.variant.as_deref());
        let broken = compiled.broken_variants.iter();
        let broken = broken.filter(|(of, _)| *of == task.task);
        let variants = listed("likewise its variants", variants);
        let broken = broken.map(|(_, variant)| variant.as_str());
        let broken = listed("its variants with errors", broken);
        io.data(&format!("{file}: {}{variants}{broken}", task.in_words()));
    }
    if tasks.is_empty() && !compiled.has_errors() {
        io.data(&format!(
            "{file}: no errors; it declares no task that can run by itself"
        ));
    }
}

/// Lists names on a line of their own, if there are any.
fn listed<'n>(what: &str, names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() {
        return String::new();
    }
    format!("\n  {what}: {}", names.join(", "))
}

impl CheckedTask {
    /// Describes a program; `beside` is the folder of its file.
    fn of(program: &Program, file: &str, beside: &Path) -> CheckedTask {
        let per_step = program.calls_per_step();
        let material = program.cloth.material.as_ref();
        CheckedTask {
            task: program.task.clone(),
            variant: program.variant.clone(),
            file: file.to_owned(),
            program: program.hash(),
            horizon: program.horizon,
            max_calls_per_step: per_step,
            max_calls: u64::from(per_step) * u64::from(program.horizon),
            spaces: Spaces::of(program),
            about: program.about.clone(),
            demonstration: unjudged(program, beside),
            material: material.map(|it| it.name.clone()),
            simulated: material.and_then(|it| differs(it, program.cloth.spacing_m)),
        }
    }

    fn in_words(&self) -> String {
        let mut lines = vec![format!(
            "task `{}` has no errors; at most {} model calls per step, {} in {}",
            self.task,
            self.max_calls_per_step,
            self.max_calls,
            counted(self.horizon as usize, "step")
        )];
        lines.extend(self.about.iter().map(|it| format!("  about: {it}")));
        lines.extend(self.demonstration.map(|it| format!("  {it}")));
        lines.extend(self.material.iter().map(|it| format!("  made of {it}")));
        let differences = self.simulated.iter().flatten();
        lines.extend(differences.map(|it| format!("    in the simulator, {it}")));
        lines.join("\n")
    }
}

fn unjudged(program: &Program, beside: &Path) -> Option<&'static str> {
    let wanted = program.demonstration_hash()?;
    let titles = [program.title(), program.task.clone()];
    let tried = titles.map(|title| sources::pinned_trial(beside, &title));
    let tried: Vec<_> = tried.iter().flatten().collect();
    let offers = Some(program.offers_hash());
    let of_these_folds: Vec<_> = tried.iter().filter(|it| it.of == wanted).collect();
    if of_these_folds.iter().any(|it| it.offers == offers) {
        return None;
    }
    Some(if !of_these_folds.is_empty() {
        "its camera, keypoints or actions have changed: `fabc subgoals` tells whether they offer the points of its demonstration"
    } else if tried.is_empty() {
        "its demonstration was never tried: `fabc subgoals` draws its pictures, and tells whether each step changes the cloth"
    } else {
        "its pictures are of another cloth, picker or demonstration: `fabc subgoals` draws them anew, and tells whether each step changes the cloth"
    })
}

/// Returns in what the simulated cloth of a material differs from it; `None` if it cannot be laid, which F0512 reports.
#[cfg(feature = "runtime")]
fn differs(material: &Material, spacing_m: f64) -> Option<Vec<String>> {
    let warnings = fab_world::material(material).check(spacing_m as f32).ok()?;
    Some(warnings.iter().map(ToString::to_string).collect())
}

#[cfg(not(feature = "runtime"))]
fn differs(_: &Material, _: f64) -> Option<Vec<String>> {
    None
}
