//! Decides whether tasks are right, and builds the programs of those that are.
//!
//! In: every file as written. Out: programs of the entry file's runnable tasks, and diagnostics. Every task
//! of every file is checked, bases too; only [`check`] makes a [`Program`], so that one is right by
//! construction. One file per section; each gives its part of the program or nothing.

mod actions;
mod arguments;
mod camera;
mod cloth;
mod conditions;
mod folds;
mod goal;
mod keypoints;
mod model;
mod names;
mod pictures;
mod quantity;
mod reads;
mod stages;
mod subgoals;
mod templates;
mod verification;

use crate::ast::{Ident, Task};
use crate::diag::{Code, Diagnostic, Report, among, nearest};
use crate::load::Loaded;
use crate::merge::{self, Merged};
use crate::program::{PROGRAM_FORMAT, Program, SourceStamp, hex};
use crate::source::Span;
use names::Names;
use sha2::{Digest, Sha256};

/// The most text, bytes, that all tasks of a compilation have together, each with what it inherits: a thousand
/// tasks that share a long library stay far below it, and without it work would grow with the square of a file.
pub const MAX_INHERITED_BYTES: usize = 16 << 20;

/// What the checks of one task share.
pub(crate) struct Context<'a> {
    pub loaded: &'a Loaded,
    pub report: &'a mut Report,
    pub names: Names<'a>,
}

impl Context<'_> {
    /// Returns what stands at a place, cut to a length that fits a message.
    pub fn written(&self, span: Span) -> String {
        const MOST: usize = 40;
        let text = self.loaded.sources.text(span);
        if text.chars().count() <= MOST {
            text.to_owned()
        } else {
            text.chars().take(MOST).chain(['…']).collect()
        }
    }

    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.report.push(diagnostic);
    }

    /// Reports a name that nothing of `kind` has, unless it may be declared where something did not fit.
    pub fn unknown<'c>(
        &mut self,
        kind: &str,
        name: &Ident,
        candidates: impl IntoIterator<Item = &'c str>,
    ) {
        if self.names.may_be_declared(&name.text) {
            return;
        }
        let candidates: Vec<&str> = candidates.into_iter().collect();
        let diagnostic = Diagnostic::new(
            Code::UnknownName,
            name.span,
            format!("there is no {kind} `{}`", name.text),
        );
        self.push(match nearest(&name.text, candidates.iter().copied()) {
            Some(meant) => diagnostic
                .help(format!("did you mean `{meant}`?"))
                .edit(name.span, meant),
            None if candidates.is_empty() => diagnostic,
            None => diagnostic.help(format!("there is {}", among(candidates))),
        });
    }
}

/// Checks every task of every file; returns the programs of the entry's.
pub(crate) fn check(loaded: &Loaded, report: &mut Report) -> Vec<Program> {
    merge::unique(
        loaded
            .files
            .iter()
            .flat_map(|file| &file.tasks)
            .map(|task| &task.name),
        "task",
        report,
    );
    merge::unique(
        loaded
            .files
            .iter()
            .flat_map(|file| &file.experts)
            .map(|experts| &experts.name),
        "list of experts",
        report,
    );
    let mut context = Context {
        loaded,
        report,
        names: Names::none(loaded),
    };
    for experts in loaded.files.iter().flat_map(|file| &file.experts) {
        folds::experts(experts, &mut context);
    }
    let faulty_files = report.files_with_errors();
    let mut programs = Vec::new();
    let stamps = stamps(loaded);
    let mut inherited_bytes = 0usize;
    'files: for file in &loaded.files {
        for task in &file.tasks {
            inherited_bytes += merge::size(task, loaded);
            if inherited_bytes > MAX_INHERITED_BYTES {
                let message = format!(
                    "the tasks up to `{}` have, with what they inherit, more than {MAX_INHERITED_BYTES} bytes; the rest is not checked",
                    task.name.text
                );
                report.push(
                    Diagnostic::new(Code::InheritsTooMuch, task.name.span, message)
                        .help("put the tasks into several files, and check each by itself"),
                );
                break 'files;
            }
            // Each task has its own report: what it inherits must count against it, though it is shown once.
            let mut own = Report::default();
            let program = self::task(task, loaded, &stamps, &mut own);
            let is_right = own.errors() == 0
                && loaded
                    .visible_from(file.id)
                    .all(|seen| !faulty_files.contains(&seen.id));
            report.absorb(own);
            programs.extend(program.filter(|_| is_right && file.id == loaded.entry().id));
        }
    }
    programs
}

/// Checks one task; the program counts only where nothing was reported.
fn task(
    task: &Task,
    loaded: &Loaded,
    stamps: &[SourceStamp],
    report: &mut Report,
) -> Option<Program> {
    let merged = merge::merge(task, loaded, report);
    let names = Names::of(&merged, loaded);
    let mut context = Context {
        loaded,
        report,
        names,
    };
    let cloth = merged
        .cloth
        .and_then(|statement| cloth::check(statement, &mut context));
    let camera = merged
        .camera
        .and_then(|statement| camera::check(statement, &mut context));
    if let (Some(cloth), Some(laid), Some(camera), Some(seen)) =
        (&cloth, merged.cloth, &camera, merged.camera)
    {
        camera::compare(cloth, laid, camera, seen, &mut context);
    }
    let keypoints = keypoints::check(&merged, camera.as_ref(), &mut context);
    let actions = merged
        .actions
        .map_or(Vec::new(), |part| actions::check(part, &mut context));
    let subgoals = merged
        .subgoals
        .and_then(|part| subgoals::check(part, &mut context));
    let experts = folds::expert_sequences(&merged, subgoals.as_ref(), &mut context);
    let horizon = goal::horizon(&merged, subgoals.as_ref(), &mut context);
    let goal = merged
        .goal
        .and_then(|statement| goal::check(statement, &merged, &experts, &mut context));
    let mut prompts = stages::check(&merged, &actions, &mut context);
    let verify = verification::check(&merged, &actions, &mut prompts.templates, &mut context);
    if !is_complete(&merged, loaded, report) {
        return None;
    }
    Some(Program {
        format: PROGRAM_FORMAT,
        compiler: env!("CARGO_PKG_VERSION").to_owned(),
        task: task.name.text.clone(),
        variant: None,
        sources: stamps.to_vec(),
        cloth: cloth?,
        camera: camera?,
        subgoals: Some(subgoals?),
        experts,
        keypoints,
        layers: Vec::new(),
        actions,
        templates: prompts.templates,
        stages: prompts.stages,
        verify,
        horizon: horizon?,
        goal,
    })
}

fn stamps(loaded: &Loaded) -> Vec<SourceStamp> {
    let stamp = |(source, name): (&crate::Source, &String)| SourceStamp {
        name: name.clone(),
        sha256: hex(&Sha256::digest(source.text.as_bytes())),
    };
    loaded
        .sources
        .iter()
        .zip(&loaded.portable_names)
        .map(stamp)
        .collect()
}

/// Returns whether the task has all that a rollout needs, and says what it lacks.
///
/// A task with cloth, subgoals and stages is meant to run, so that a lack of anything else is an error; one
/// without them may serve as a base.
fn is_complete(merged: &Merged<'_>, loaded: &Loaded, report: &mut Report) -> bool {
    let lacks = |parts: &[(&'static str, bool)]| -> Vec<&'static str> {
        parts
            .iter()
            .filter(|(_, is_there)| !is_there)
            .map(|(name, _)| *name)
            .collect()
    };
    let own = lacks(&[
        ("cloth", merged.cloth.is_some()),
        ("subgoals", merged.subgoals.is_some()),
        ("stage", !merged.stages.is_empty()),
    ]);
    let shared = lacks(&[
        ("camera", merged.camera.is_some()),
        ("keypoints", !merged.keypoints.is_empty()),
        ("actions", merged.actions.is_some()),
    ]);
    let is_complete = own.is_empty() && shared.is_empty();
    if is_complete || merged.has_faults || merged.is_broken {
        return is_complete;
    }
    let name = &merged.task.name;
    if own.is_empty() {
        for section in shared {
            let message = format!("`{}` has no `{section}`", name.text);
            report.push(
                Diagnostic::new(Code::MissingSection, name.span, message)
                    .help("write the section, or extend a task that has it"),
            );
        }
        return false;
    }
    if !loaded.is_extended(merged.task) && name.span.file == loaded.entry().id {
        let lacking: Vec<&str> = own.into_iter().chain(shared).collect();
        let message = format!(
            "`{}` cannot run by itself: it has no {}",
            name.text,
            among(lacking)
        );
        report.push(
            Diagnostic::new(Code::BaseOnly, name.span, message)
                .help("that is right for a task that others extend"),
        );
    }
    false
}
