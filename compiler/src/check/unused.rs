//! Names that nothing uses, and fields that nothing acts on.
//!
//! Neither is an error: a library may declare what other tasks use. A new name that nothing uses is reported if an
//! inherited one is similar, because it was probably meant to replace that one.

use super::context::Context;
use crate::diag::{Code, Diagnostic, nearest};
use crate::lang::actions::{FIELDS, field as moving_field};
use crate::load::Loaded;
use crate::merge::{MAX_EXTENDS_DEPTH, Merged};
use fab_grammar::ast::{Body, Name, Task};
use fab_program::{Depends, Program, Uses};
use std::collections::BTreeSet;

/// Warns of the task's own constants and keypoints that nothing uses and that are named almost like inherited ones.
pub(crate) fn names(merged: &Merged<'_>, context: &mut Context<'_, '_>) {
    let Some(own) = merged.own_body() else {
        return;
    };
    let above = above(merged, context.loaded);
    let all = |names: fn(Body<'_>) -> Vec<Name<'_>>| -> BTreeSet<&str> {
        let above = above.iter().flat_map(|body| names(*body));
        above.map(|name| name.text()).collect()
    };
    let kinds = [
        ("constant", constants(own), all(constants)),
        ("keypoint", keypoints(own), all(keypoints)),
    ];
    for (kind, own, inherited) in kinds {
        for name in own {
            if inherited.contains(name.text()) || context.loaded.is_used(name.text()) {
                continue;
            }
            let Some(meant) = nearest(name.text(), inherited.iter().copied()) else {
                continue;
            };
            let message = format!(
                "the {kind} `{}` is new, and nothing uses it; there is an inherited {kind} `{meant}`",
                name.text()
            );
            let diagnostic = Diagnostic::new(Code::UnusedName, name.span(), message);
            context.remark(diagnostic.meant(name.span(), meant));
        }
    }
}

/// Warns of the constants and keypoints of a whole task in the first file, or of a variant, that nothing uses.
///
/// A library, and a task that lacks parts, may declare what others use. Names that are almost inherited ones are
/// reported by [`names`].
pub(crate) fn whole(merged: &Merged<'_>, context: &mut Context<'_, '_>) {
    let entry = context.loaded.entry().id;
    let Some(own) = merged.own_body().filter(|own| own.span().file == entry) else {
        return;
    };
    let above = above(merged, context.loaded);
    for (kind, names) in [
        ("constant", constants as fn(Body<'_>) -> Vec<Name<'_>>),
        ("keypoint", keypoints),
    ] {
        let inherited: BTreeSet<&str> = above
            .iter()
            .flat_map(|body| names(*body))
            .map(|name| name.text())
            .collect();
        let own = names(own);
        for name in &own {
            let word = name.text();
            let is_reported = nearest(word, inherited.iter().copied()).is_some();
            if is_reported || context.loaded.is_used(word) {
                continue;
            }
            let message = format!("nothing uses the {kind} `{word}`");
            let diagnostic = Diagnostic::new(Code::UnusedName, name.span(), message);
            let others = own.iter().map(|other| other.text());
            let meant = nearest(word, others.filter(|other| *other != word));
            context.remark(match meant {
                Some(meant) => {
                    diagnostic.help(format!("remove it, or use it; there is also `{meant}`"))
                }
                None => {
                    diagnostic.help("remove it, or use it in a check, a text or another keypoint")
                }
            });
        }
    }
}

/// Returns the tasks that a task extends; of a variant, its task and those that it extends.
fn above<'a>(merged: &Merged<'a>, loaded: &Loaded<'a>) -> Vec<Body<'a>> {
    let task = merged.variant.is_some().then_some(merged.task);
    let all = task.into_iter().chain(bases(merged.task, loaded));
    all.map(Task::body).collect()
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
pub(crate) fn fields(program: &Program, merged: &Merged<'_>, context: &mut Context<'_, '_>) {
    let mut read = Uses::default();
    for check in &program.verify.checks {
        let conditions = check.when.iter().chain([&check.holds]);
        conditions.for_each(|part| part.add_uses(&mut read));
    }
    for field in merged.actions.into_iter().flat_map(|part| part.fields()) {
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
