//! `fabc check`: reports what is wrong with files, and the most model calls that a task can make.

mod fix;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::{shipped, sources, watch};
use clap::Args;
use clap::ValueHint;
use fab_base::wording::counted;
use fab_compiler::diag::{self, Severity};
use fab_program::{Material, Program};
use fix::Effect;
use serde_json::{Value, json};
use std::path::Path;

/// Arguments of `check`.
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

/// Checks every file, once or after every change.
pub fn run(arguments: &CheckArguments, io: &Io) -> Result<Exit, Failure> {
    if arguments.watch {
        watch::run(&arguments.files, &[], || check(arguments, io), io)
    } else {
        check(arguments, io)
    }
}

/// Checks every file; one file's faults do not stop the others.
fn check(arguments: &CheckArguments, io: &Io) -> Result<Exit, Failure> {
    let mut exit = Exit::Done;
    let mut diagnostics = Vec::new();
    let mut tasks = Vec::new();
    let mut errors = Vec::new();
    let mut left_out = 0;
    let mut n_warnings = 0;
    let found = arguments.files.iter().map(|file| shipped::find(file, io));
    let mut found: Vec<Result<String, Failure>> = found.collect();
    let effect = if arguments.diff {
        Effect::Show
    } else {
        Effect::Write
    };
    // A file may use one that is named after it, so all are fixed before any is reported.
    let diff = if arguments.fix {
        fix::run(&mut found, effect, io)
    } else {
        String::new()
    };
    if effect == Effect::Show && !arguments.json && !diff.is_empty() {
        io.data(diff.trim_end_matches('\n'));
    }
    for (file, found) in arguments.files.iter().zip(found) {
        let named = diag::visible(file);
        let beside = sources::folder_of(found.as_deref().unwrap_or(file));
        let compiled = found.and_then(|file| sources::compile_looking(&file));
        let (compiled, notes_on_pictures) = match compiled {
            Ok(compiled) => compiled,
            Err(failure) => {
                io.talk(&format!("error: {failure}"));
                errors.push(failure.to_string());
                exit = Exit::Environment;
                continue;
            }
        };
        for note in notes_on_pictures {
            io.talk(&format!("note: {note}"));
        }
        let severities = compiled.diagnostics.iter().map(|it| it.severity);
        n_warnings += severities.filter(|it| *it == Severity::Warning).count();
        if compiled.has_errors() && exit == Exit::Done {
            exit = Exit::Author;
        }
        left_out += compiled.left_out;
        if arguments.json {
            if let Value::Array(found) = diag::to_json(&compiled.diagnostics, &compiled.sources) {
                diagnostics.extend(found);
            }
        } else if !compiled.diagnostics.is_empty() {
            io.painted_data(&sources::findings(&compiled, io.data_color()));
        }
        for (number, program) in compiled.programs.iter().enumerate() {
            let per_step = program.calls_per_step();
            let calls = u64::from(per_step) * u64::from(program.horizon);
            if !arguments.json && program.variant.is_none() {
                io.data(&format!(
                    "{named}: task `{}` has no errors; at most {per_step} model calls per step, {calls} in {}{}{}{}",
                    program.task,
                    counted(program.horizon as usize, "step"),
                    notes(program, &beside),
                    variants(&compiled.programs[number + 1..]),
                    broken_variants(&compiled.broken_variants, &program.task),
                ));
            }
            let mut task = json!({
                "task": program.task,
                "variant": program.variant,
                "file": file,
                "program": program.hash(),
                "horizon": program.horizon,
                "max_calls_per_step": per_step,
                "max_calls": calls,
            });
            for (name, note) in program.notes() {
                task[name] = json!(note);
            }
            task["demonstration"] = json!(unjudged(program, &beside));
            if let Some(material) = &program.cloth.material {
                let differs = differs(material, program.cloth.spacing_m);
                task["material"] = json!({ "name": material.name, "sources": material.sources, "simulated": differs });
            }
            tasks.push(task);
        }
        if !arguments.json && compiled.programs.is_empty() && !compiled.has_errors() {
            io.data(&format!(
                "{named}: no errors; it declares no task that can run by itself"
            ));
        }
    }
    if arguments.deny_warnings && n_warnings > 0 && exit == Exit::Done {
        let count = counted(n_warnings, "warning");
        io.talk(&format!(
            "error: {count}, and `--deny-warnings` allows none"
        ));
        exit = Exit::Author;
    }
    if arguments.json {
        let mut document = json!({ "diagnostics": diagnostics, "diagnostics_left_out": left_out, "tasks": tasks, "errors": errors });
        if effect == Effect::Show {
            document["diff"] = json!(diff);
        }
        io.json(&document);
    }
    Ok(exit)
}

/// Formats the notes about a task, where its material's values come from, and how the simulated cloth differs from it, one
/// per line.
///
/// - `beside`: the task's folder.
fn notes(program: &Program, beside: &Path) -> String {
    let notes = program.notes().into_iter();
    let notes = notes.map(|(name, note)| format!("\n  {name}: {note}"));
    let unjudged = unjudged(program, beside).map(|why| format!("\n  {why}"));
    let material = program.cloth.material.iter().flat_map(|material| {
        let sources = material.sources.iter();
        let sources = sources.map(|it| format!("\n    {}: {}", it.property, it.from));
        let differs = differs(material, program.cloth.spacing_m);
        let differs = differs
            .into_iter()
            .flatten()
            .map(|it| format!("\n    in the simulator, {it}"));
        std::iter::once(format!("\n  made of {}", material.name))
            .chain(sources)
            .chain(differs)
    });
    notes.chain(unjudged).chain(material).collect()
}

/// Returns a note if the steps of the demonstration have not been judged.
fn unjudged(program: &Program, beside: &Path) -> Option<&'static str> {
    let wanted = program.demonstration_hash()?;
    let titles = [program.title(), program.task.clone()];
    let tried = titles.map(|title| sources::pinned_trial(beside, &title));
    let mut tried = tried.iter().flatten().peekable();
    if tried.peek().is_none() {
        return Some(
            "its demonstration was never tried: `fabc subgoals` draws its pictures, and tells whether each step changes the cloth",
        );
    }
    let is_another = tried.all(|it| it.of != wanted);
    is_another.then_some(
        "its pictures are of another cloth, picker or demonstration: `fabc subgoals` draws them anew, and tells whether each step changes the cloth",
    )
}

/// Returns in what the simulated cloth of a material differs from it; `None` if it cannot be laid, which F0512 reports.
#[cfg(feature = "runtime")]
fn differs(material: &Material, spacing_m: f64) -> Option<Vec<String>> {
    let warnings = fab_world::material(material).check(spacing_m as f32).ok()?;
    Some(warnings.iter().map(ToString::to_string).collect())
}

/// Returns nothing: without a simulator no cloth is simulated.
#[cfg(not(feature = "runtime"))]
fn differs(_: &Material, _: f64) -> Option<Vec<String>> {
    None
}

/// Lists the variants of a task, which follow it in `following`.
fn variants(following: &[Program]) -> String {
    let names: Vec<&str> = following
        .iter()
        .map_while(|program| program.variant.as_deref())
        .collect();
    if names.is_empty() {
        String::new()
    } else {
        format!("\n  likewise its variants: {}", names.join(", "))
    }
}

/// Names the variants of a task that have errors of their own.
fn broken_variants(broken: &[(String, String)], task: &str) -> String {
    let own = broken.iter().filter(|(of, _)| of == task);
    let names: Vec<&str> = own.map(|(_, variant)| variant.as_str()).collect();
    match names.as_slice() {
        [] => String::new(),
        names => format!("\n  its variants with errors: {}", names.join(", ")),
    }
}
