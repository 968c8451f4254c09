//! Checks one task, section by section, and puts its program together.

use super::names::Names;
use super::{
    Context, actions, camera, cloth, constants, demos, folds, goal, keypoints, layers, picker,
    stages, subgoals, trials, verification,
};
use crate::diag::{Code, Diagnostic, Report, among};
use crate::load::Loaded;
use crate::merge::Merged;
use crate::proof;
use fab_program::{PROGRAM_FORMAT, Picker, Program, SourceStamp, Test, hex};
use sha2::{Digest, Sha256};

/// Checks one task or variant; what is returned counts only where nothing was reported.
pub(super) fn check(
    merged: &Merged<'_>,
    stamps: &[SourceStamp],
    grid: Option<[u32; 2]>,
    loaded: &Loaded,
    report: &mut Report,
) -> Option<(Program, Vec<Test>)> {
    let mut context = Context::empty(loaded, report);
    context.grid = grid;
    context.names = Names::of(merged, loaded);
    context.constants = merged
        .constants
        .iter()
        .map(|constant| (constant.name.text.as_str(), constant))
        .collect();
    context.declared_layers = merged
        .annotate
        .iter()
        .flat_map(|part| &part.list)
        .map(|layer| layer.name.text.as_str())
        .collect();
    constants::check(merged, &mut context);
    context.cloth = merged
        .cloth
        .and_then(|statement| cloth::check(statement, &mut context));
    context.camera = merged
        .camera
        .and_then(|statement| camera::check(statement, &mut context));
    if let (Some(laid), Some(seen)) = (merged.cloth, merged.camera) {
        camera::compare(laid, seen, &mut context);
    }
    let picker = merged.picker.map_or(Some(Picker::default()), |statement| {
        picker::check(statement, &mut context)
    });
    let keypoints = keypoints::check(merged, &mut context);
    if let Some(part) = merged.actions {
        context.actions = actions::check(part, &mut context);
    }
    context.layers = layers::check(merged, &mut context);
    let last_layers = context.layers.iter().filter(|layer| layer.uses_last());
    context.last_layers = last_layers.map(|layer| layer.name.clone()).collect();
    let subgoals = merged
        .subgoals
        .and_then(|part| subgoals::check(part, &mut context));
    let experts = folds::expert_sequences(merged, subgoals.as_ref(), &mut context);
    let horizon = goal::horizon(merged, subgoals.as_ref(), &mut context);
    let goal = merged
        .goal
        .and_then(|statement| goal::check(statement, merged, &experts, &mut context));
    let mut prompts = stages::check(merged, &mut context);
    let demos = merged
        .demos
        .and_then(|part| demos::check(part, merged, &prompts.stages, &mut context));
    let verify = verification::check(merged, &mut prompts, &mut context);
    let tests = if merged.variant.is_none() {
        trials::check(merged, &prompts.stages, &mut context)
    } else {
        Vec::new()
    };
    let Context {
        cloth,
        camera,
        actions,
        layers,
        ..
    } = context;
    if !is_complete(merged, loaded, report) || merged.subgoals.is_some() && subgoals.is_none() {
        return None;
    }
    let program = Program {
        format: PROGRAM_FORMAT,
        compiler: env!("CARGO_PKG_VERSION").to_owned(),
        task: merged.task.name.text.clone(),
        variant: merged.variant.as_ref().map(|variant| variant.name.clone()),
        sources: stamps.to_vec(),
        cloth: cloth?,
        camera: camera?,
        picker: picker?,
        subgoals,
        experts,
        keypoints,
        layers,
        actions,
        templates: prompts.templates,
        stages: prompts.stages,
        demos,
        verify,
        horizon: horizon?,
        goal,
    };
    if report.errors() == 0 && !merged.sees_faults {
        contradictions(&program, merged, report);
    }
    Some((program, tests))
}

/// Reports where the action space contradicts itself.
fn contradictions(program: &Program, merged: &Merged<'_>, report: &mut Report) {
    let Some(part) = merged.actions else {
        return;
    };
    for flaw in proof::flaws(program) {
        let field = part
            .fields
            .iter()
            .find(|field| field.name.text == flaw.field);
        let span = field.map_or(part.span, |field| field.name.span);
        report.push(Diagnostic::new(Code::Contradiction, span, flaw.message));
    }
}

/// Returns the name and hash of every source.
pub(super) fn stamps(loaded: &Loaded) -> Vec<SourceStamp> {
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
/// A task with cloth, subgoals or a horizon, and stages is meant to run, so that a lack of anything else is an
/// error; one without them may serve as a base.
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
        (
            "subgoals",
            merged.subgoals.is_some() || !merged.needs_subgoals(),
        ),
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
    let is_base = loaded.is_extended(merged.task);
    if !is_base && !merged.sees_faults && name.span.file == loaded.entry().id {
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
