//! Names that nothing uses, and fields that nothing acts on.
//!
//! Neither is an error: a library may declare what other tasks use. A new name that nothing uses is reported if an
//! inherited one is similar, because it was probably meant to replace that one.

use super::context::Context;
use crate::diag::{Code, Diagnostic, Report, nearest};
use crate::lang::actions::{FIELDS, field as moving_field};
use crate::load::Loaded;
use crate::merge::{MAX_EXTENDS_DEPTH, Merged};
use fab_grammar::Span;
use fab_grammar::ast::{Body, File, Name, Task};
use fab_program::{Depends, Program, Uses};
use std::collections::BTreeSet;

/// Warns of the constants and keypoints that nothing uses.
///
/// A library, and a task that lacks parts, may declare what others use: there, a name is only reported if it is almost
/// an inherited one.
///
/// - `running`: the bodies of tasks and variants that can run.
pub(crate) fn names(loaded: &Loaded<'_>, running: &BTreeSet<Span>, report: &mut Report) {
    for task in loaded.well_formed().flat_map(File::tasks) {
        let mut above: Vec<Body<'_>> = bases(task, loaded).map(Task::body).collect();
        own_names(task.body(), &above, loaded, running, report);
        above.push(task.body());
        for variant in task.variants() {
            own_names(variant.body(), &above, loaded, running, report);
        }
    }
}

/// - `above`: what the body is joined with.
fn own_names(
    body: Body<'_>,
    above: &[Body<'_>],
    loaded: &Loaded<'_>,
    running: &BTreeSet<Span>,
    report: &mut Report,
) {
    let inherited = above.iter().flat_map(|body| declared(*body));
    let inherited = inherited.map(|(kind, name)| (kind, name.text()));
    let inherited: BTreeSet<(&str, &str)> = inherited.collect();
    for (kind, name) in declared(body) {
        let word = name.text();
        if inherited.contains(&(kind, word)) || loaded.is_used(word) {
            continue;
        }
        let new = |message: String| Diagnostic::new(Code::UnusedName, name.span(), message);
        let alike = inherited.iter().filter(|(other, _)| *other == kind);
        if let Some(meant) = nearest(word, alike.map(|(_, word)| *word)) {
            let message = format!(
                "the {kind} `{word}` is new, and nothing uses it; there is an inherited {kind} `{meant}`"
            );
            report.remark(new(message).meant(name.span(), meant));
        } else if running.contains(&body.span()) {
            let help = "remove it, or use it in a check, a text or another keypoint";
            report.remark(new(format!("nothing uses the {kind} `{word}`")).help(help));
        }
    }
}

/// Returns the constants and keypoints that a body declares, each with its kind.
fn declared(body: Body<'_>) -> impl Iterator<Item = (&'static str, Name<'_>)> {
    let constants = body.constants().map(|it| ("constant", it.name()));
    let keypoints = body.keypoints().flat_map(|part| part.list());
    constants.chain(keypoints.map(|it| ("keypoint", it.name())))
}

/// Warns of the materials and lists of experts of the first file that nothing uses. A file without tasks declares them
/// for others.
pub(crate) fn outside_of_tasks(loaded: &Loaded<'_>, report: &mut Report) {
    let entry = loaded.entry();
    if entry.tasks().next().is_none() || loaded.is_malformed(entry.span().file) {
        return;
    }
    for name in entry.materials().map(|material| material.name()) {
        let word = name.text();
        if !loaded.is_used(word) {
            let message = format!("nothing uses the material `{word}`");
            let help =
                format!("remove it, or write it into a cloth: `square(340mm, material: {word})`");
            let diagnostic = Diagnostic::new(Code::UnusedName, name.span(), message);
            report.remark(diagnostic.help(help));
        }
    }
    // Otherwise an error may be why.
    if report.has_errors().is_err() {
        return;
    }
    let tasks = loaded.files.iter().flat_map(|file| file.tasks());
    let bodies = tasks.flat_map(|task| {
        let variants = task.variants().map(|variant| variant.body());
        variants.chain([task.body()])
    });
    let named = bodies.flat_map(|body| body.experts());
    let named: BTreeSet<&str> = named.map(|it| it.name().text()).collect();
    for name in entry.experts().map(|list| list.name()) {
        let word = name.text();
        if !named.contains(word) {
            let message = format!("no task names the experts `{word}`");
            let help = format!("remove them, or write `experts {word}` into a task");
            let diagnostic = Diagnostic::new(Code::UnusedName, name.span(), message);
            report.remark(diagnostic.help(help));
        }
    }
}

/// Returns the tasks that a task extends, nearest first.
fn bases<'a>(task: Task<'a>, loaded: &Loaded<'a>) -> impl Iterator<Item = Task<'a>> {
    let above = |task: &Task<'a>| {
        let base = task.extends()?;
        loaded.task(base.span().file, base.text())
    };
    // A circle was reported; here it only has to end.
    std::iter::successors(above(&task), above).take(MAX_EXTENDS_DEPTH)
}

// ---- fields --------------------------------------------------------------------------------------

/// Notes the fields that neither act on the gripper nor decide a check.
pub(crate) fn fields(program: &Program, merged: &Merged<'_>, context: &mut Context<'_>) {
    let mut read = Uses::default();
    for check in &program.verify.checks {
        let conditions = check.when.iter().chain([&check.holds]);
        conditions.for_each(|part| part.add_uses(&mut read));
    }
    for field in merged.actions().into_iter().flat_map(|part| part.fields()) {
        let name = field.name().text();
        if moving_field(name).is_some() || read.fields.contains(name) {
            continue;
        }
        let message = format!("nothing acts on the field `{name}`");
        let diagnostic = Diagnostic::new(Code::FieldMovesNothing, field.name().span(), message);
        let help = "the model is asked for it and its answer is recorded; no check reads it, and it does not move the cloth: remove it, or read it in a check";
        let acting = FIELDS.iter().filter(|row| !row.is_expected);
        context.remark(match nearest(name, acting.map(|row| row.name)) {
            Some(meant) => diagnostic.help(format!("{help}; there is `{meant}`, which acts")),
            None => diagnostic.help(help),
        });
    }
}
