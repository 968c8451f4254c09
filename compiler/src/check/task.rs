//! Checks one task, section by section, and assembles its program.
//!
//! Every part of the program under construction is present, absent, or replaced by the proof of its error. A
//! [`Program`] is built only if no part has an error, so no part of it can be missing.

use super::context::{Context, Declared, Result, declared};
use super::names::Names;
use super::short_text::short;
use super::{
    actions, annotate, camera, choices, cloth, demos, effect, experts, goal, horizon, keypoints,
    picker, rehearse, stage, subgoals, test, unspoken, unused, verify,
};
use crate::diag::{Code, among};
use crate::lang::sections::{RequiredFor, SECTIONS};
use crate::load::Loaded;
use crate::merge::Merged;
use fab_grammar::ast::{Expr, Statement};
use fab_program::{PROGRAM_FORMAT, Program, SourceStamp, Test, hex};
use sha2::{Digest, Sha256};

/// A task's program and its tests; `None` for a base, which cannot run by itself.
pub(super) type Built = Declared<(Program, Vec<Test>)>;

/// Checks one task or variant.
///
/// - `form`: `Err` if a file that the task sees has an error outside of tasks; later errors may then be noise.
pub(super) fn check<'a>(
    merged: &Merged<'a>,
    stamps: &[SourceStamp],
    form: Result<()>,
    context: &mut Context<'a>,
) -> Built {
    context.names = Names::of(merged, context.report);
    keypoints::constants(merged, context);
    let about = declared(merged.statement("about"), |it| about(it, context));
    let statement = |word| merged.statement(word);
    context.cloth = declared(statement("cloth"), |it| cloth::check(it, context));
    context.camera = declared(statement("camera"), |it| camera::check(it, context));
    if let (Some(laid), Some(seen)) = (statement("cloth"), statement("camera")) {
        camera::fits_cloth(laid, seen, context);
    }
    let picker = declared(statement("picker"), |it| picker::check(it, context));
    if let Ok(Some((_, manner))) = &picker {
        picker::stated_once(manner, merged, context);
    }
    context.keypoints = keypoints::check(merged, context);
    if let Some(seen) = statement("camera") {
        camera::masks_see_cloth(seen, merged, context);
    }
    camera::cloth_is_first(merged, context);
    if let Some(part) = merged.actions() {
        actions::check(part, context);
    }
    annotate::check(merged, context);
    context.subgoals = declared(merged.subgoals(), |it| subgoals::check(it, context));
    subgoals::begin_flat(merged, context);
    let experts = experts::sequences(merged, context);
    context.horizon = horizon::check(merged, context);
    let goal = declared(statement("goal"), |it| {
        goal::check(it, merged, &experts, context)
    });
    stage::check(merged, context);
    let demos = merged.demos().map(|part| demos::check(part, context));
    let verify = verify::check(merged, context);
    let rehearsal = merged
        .rehearse()
        .map(|part| rehearse::check(part, merged, context));
    rehearse::candidates(merged, context);
    let tests = test::check(merged, context);
    let (cloth, camera) = (context.cloth.clone(), context.camera.clone());
    let is_whole = is_whole(merged, form, context);
    // Any reported error counts, in whichever part.
    context.report.has_errors()?;
    merged.joined?;
    form?;
    // Only now, because a check that did not parse would seem to be dropped.
    verify::dropped(merged, context.report);
    let (Some(cloth), Some(camera), Some(horizon), true) =
        (cloth?, camera?, context.horizon?, is_whole)
    else {
        return Ok(None);
    };
    context.complete?;
    let (picker, manner) = picker?.unwrap_or_else(Default::default);
    let program = Program {
        format: PROGRAM_FORMAT,
        compiler: env!("CARGO_PKG_VERSION").to_owned(),
        task: merged.task.name().text().to_owned(),
        variant: merged.variant.as_ref().map(|it| it.name.to_string()),
        about: about?,
        sources: stamps.to_vec(),
        cloth,
        camera,
        picker,
        manner,
        subgoals: context.subgoals.clone()?,
        experts: experts?,
        keypoints: context.keypoints.clone()?,
        layers: context.layers.take()?,
        actions: context.actions.take()?,
        templates: context.templates.drain(..).collect::<Result<_>>()?,
        stages: context.stages.take()?,
        demos: demos.transpose()?.flatten(),
        verify: verify?,
        horizon,
        goal: goal?,
        rehearsal: rehearsal.transpose()?.flatten(),
    };
    choices::check(&program.actions, merged, context.report)?;
    effect::check(&program, merged, context);
    let unsaid = |context: &mut Context<'_>| {
        unspoken::check(&program, merged, context);
        unused::fields(&program, merged, context);
    };
    match (&merged.variant, merged.own_body()) {
        (None, _) => unsaid(context),
        // A variant leaves parts out on purpose, so that runs can be compared: only what it states itself is judged.
        (Some(_), Some(own)) => context.within(own.span(), unsaid),
        (Some(_), None) => {}
    }
    Ok(Some((program, tests?)))
}

/// The most characters of `about`: about two lines.
const MAX_ABOUT_CHARS: usize = 200;

/// Reads what a task is for: one line in quotes.
fn about(statement: Statement<'_>, context: &mut Context<'_>) -> Result<String> {
    let Expr::Text(text) = statement.value() else {
        let help = Some("write `about \"what the task is for\"`");
        let expr = statement.value();
        return Err(context.wrong(Code::WrongForm, expr, "a text in quotes", help));
    };
    short(text, "`about`", MAX_ABOUT_CHARS, context)
}

/// Returns the name and hash of every source.
pub(super) fn stamps(loaded: &Loaded<'_>) -> Vec<SourceStamp> {
    let stamp = |(name, text): (&str, &str)| SourceStamp {
        name: name.to_owned(),
        sha256: hex(&Sha256::digest(text.as_bytes())),
    };
    loaded.portable_texts().map(stamp).collect()
}

/// Returns whether the task has everything a rollout needs, and reports what it lacks.
///
/// A task with a cloth, subgoals or a horizon, and stages is meant to run, so a missing section is an error. Without
/// these it may be a base.
fn is_whole(merged: &Merged<'_>, form: Result<()>, context: &mut Context<'_>) -> bool {
    let lacking = |needed: RequiredFor| -> Vec<&'static str> {
        let rows = SECTIONS.iter().filter(|row| row.needed == needed);
        let lacks = rows.filter(|row| !is_there(row.word, merged));
        lacks.map(|row| row.word).collect()
    };
    let (own, shared) = (
        lacking(RequiredFor::RunnableTask),
        lacking(RequiredFor::Run),
    );
    if own.is_empty() && shared.is_empty() {
        return true;
    }
    let name = merged.task.name();
    if own.is_empty() {
        for section in shared {
            let message = format!("`{}` has no `{section}`", name.text());
            let help = "write the section, or extend a task that has it";
            context.refuse(Code::MissingSection, name.span(), message, help);
        }
        return false;
    }
    let is_base = context.loaded.is_extended(merged.task);
    if !is_base && form.is_ok() && name.span().file == context.loaded.entry().span().file {
        let lacking = among(own.into_iter().chain(shared));
        let task = name.text();
        let message = format!("`{task}` cannot run by itself: it has no {lacking}");
        let help = "this is fine for a task that others extend";
        context.warn(Code::BaseOnly, name.span(), message, help);
    }
    false
}

/// Returns whether a task has a section that it needs.
fn is_there(word: &str, merged: &Merged<'_>) -> bool {
    match word {
        "subgoals" => merged.subgoals().is_some() || !merged.needs_subgoals(),
        "stage" => !merged.stages.is_empty(),
        "keypoints" => !merged.keypoints.is_empty(),
        word => merged.section(word).is_some(),
    }
}
