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
use fab_grammar::ast::{Body, Name, Task};
use fab_program::{Depends, Program, Uses};
use std::collections::BTreeSet;

/// Warns of the constants and keypoints that nothing uses.
///
/// A library, and a task that lacks parts, may declare what others use: there, a name is only reported if it is almost
/// an inherited one.
///
/// - `running`: the bodies of tasks and variants that can run.
pub(crate) fn names(loaded: &Loaded<'_>, running: &BTreeSet<Span>, report: &mut Report) {
    for task in loaded.well_formed().flat_map(|file| &file.tasks) {
        let mut above: Vec<Body<'_>> = bases(*task, loaded).map(Task::body).collect();
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
    for (kind, names) in [
        ("constant", constants as fn(Body<'_>) -> Vec<Name<'_>>),
        ("keypoint", keypoints),
    ] {
        let inherited: BTreeSet<&str> = { above.iter() }
            .flat_map(|body| names(*body))
            .map(|name| name.text())
            .collect();
        let own = names(body);
        for name in &own {
            let word = name.text();
            if inherited.contains(word) || loaded.is_used(word) {
                continue;
            }
            let new = |message: String| Diagnostic::new(Code::UnusedName, name.span(), message);
            if let Some(meant) = nearest(word, inherited.iter().copied()) {
                let message = format!(
                    "the {kind} `{word}` is new, and nothing uses it; there is an inherited {kind} `{meant}`"
                );
                report.remark(new(message).meant(name.span(), meant));
            } else if running.contains(&body.span()) {
                report.remark(
                    new(format!("nothing uses the {kind} `{word}`"))
                        .help("remove it, or use it in a check, a text or another keypoint"),
                );
            }
        }
    }
}

fn constants(body: Body<'_>) -> Vec<Name<'_>> {
    body.constants().map(|constant| constant.name()).collect()
}

fn keypoints(body: Body<'_>) -> Vec<Name<'_>> {
    let parts = body.keypoints();
    parts
        .flat_map(|part| part.list())
        .map(|keypoint| keypoint.name())
        .collect()
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
