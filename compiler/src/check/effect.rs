//! Warns of demonstrated steps that fold nothing, or that no answer can make.
//!
//! The compiler has no simulator: `fabc subgoals` executes a demonstration, and the loader gives what it found
//! ([`Trial`]). A result of another cloth, picker or list of folds is not used.

use super::context::Context;
use crate::diag::Code;
use crate::merge::Merged;
use fab_grammar::ast::{FoldBlock, Move};
use fab_program::{
    ActionField, Choices, Effect, Fold, KeypointShape, LEAST_SLIDE_MM, Program, SmallestFold,
    StepTrial, Subgoals, Trial, Unoffered, exact,
};

/// Warns of each step of the task's demonstration that folds nothing or that no answer can make, if that was found out.
pub(crate) fn check(program: &Program, merged: &Merged<'_>, context: &mut Context<'_>) {
    let (Some(Subgoals::Demonstrate { folds }), Some(part)) =
        (&program.subgoals, merged.subgoals())
    else {
        return;
    };
    let Some(trial) = trial(program, context) else {
        return;
    };
    let moves: Vec<Move<'_>> = part.demonstrations().flat_map(FoldBlock::moves).collect();
    let is_of_these_points = trial.offers == Some(program.offers_hash());
    for ((part, fold), step) in moves.iter().zip(folds).zip(&trial.steps) {
        if let Some((why, mut help)) = finding(fold, step) {
            let springs_back = matches!(step.effect, Effect::WentBack { .. });
            if springs_back && step.planned_mm >= 1.0 && program.cloth.material.is_none() {
                help.push_str(RECORDED_UNROLLS);
            }
            let message = format!("this step folds nothing: {why}");
            context.warn(Code::StepFoldsNothing, part.span(), message, help);
        }
        if is_of_these_points && !step.unoffered.is_empty() {
            let (why, help) = not_offered(program, &step.unoffered);
            let message = format!("no answer can make this step: {why}");
            context.warn(Code::StepNotOffered, part.span(), message, help);
        }
    }
}

/// What else may keep a fold of a cloth without a material.
const RECORDED_UNROLLS: &str = "; the recorded cloth unrolls, and one of a material may not: `fabc subgoals --materials` tries the shipped ones";

/// Returns how far the nearest answer is from a step, and the lines that offer the step.
fn not_offered(program: &Program, ends: &[Unoffered]) -> (String, String) {
    let nearest = ends.iter().map(|it| {
        let away_mm = exact::written(it.away_mm, 0);
        format!(
            "the nearest {} offered is {away_mm} mm away, at {}",
            it.end, it.nearest
        )
    });
    let why = nearest.collect::<Vec<_>>().join(", and ");
    let shape_of = |name: &str| program.keypoint(name).map(|it| it.extractor.shape());
    let keypoint = |field: &ActionField| {
        let end = ends.iter().find(|it| it.end == field.name)?;
        end.keypoint.as_deref()
    };
    let fields = program.actions.iter().filter(|field| field.is_point());
    if fields.clone().filter_map(keypoint).count() < ends.len() {
        let help = "no field can offer it yet: declare a keypoint that has this point, such as `points_of(outline, …)` with the words of the fold, and name it in `actions`";
        return (why, help.to_owned());
    }
    // The task may inherit its fields, and a block of its own replaces them all.
    let lines = fields.map(|field| {
        let choices = choices_with(program, field, keypoint(field));
        format!("`{}: {choices}`", field.name)
    });
    let lines = lines.collect::<Vec<_>>().join(" and ");
    let mut help = format!("write {lines} in `actions`");
    let is_mask =
        |it: &Unoffered| it.keypoint.as_deref().and_then(shape_of) == Some(KeypointShape::Mask);
    if ends.iter().any(is_mask) {
        help.push_str("; or offer just the points of the folds, as `fabc explain F0513` shows");
    }
    (why, help)
}

/// Writes a field's choices with one more keypoint; any pixel of a mask includes what the field offers now.
fn choices_with(program: &Program, field: &ActionField, more: Option<&str>) -> String {
    let shape_of = |name: &str| program.keypoint(name).map(|it| it.extractor.shape());
    match (&field.choices, more) {
        (_, Some(mask)) if shape_of(mask) == Some(KeypointShape::Mask) => format!("any of {mask}"),
        (Choices::Region { .. }, Some(keypoint)) => format!("one of {keypoint}"),
        (Choices::Region { mask }, None) => format!("any of {mask}"),
        (Choices::Points { keypoints }, more) => {
            let names = keypoints.iter().map(String::as_str).chain(more);
            format!("one of {}", names.collect::<Vec<_>>().join(", "))
        }
        _ => String::new(),
    }
}

/// Returns the results of just this demonstration: the program's own, or for a variant those of the task itself.
fn trial(program: &Program, context: &Context<'_>) -> Option<Trial> {
    let wanted = program.demonstration_hash()?;
    let mut titles = vec![program.title()];
    if program.variant.is_some() {
        titles.push(program.task.clone());
    }
    let found = titles
        .iter()
        .filter_map(|title| context.loaded.loader.trial(title));
    found.into_iter().find(|trial| trial.of == wanted)
}

/// Returns what is wrong with a step, and what to do about it; `None` if it changes the cloth.
fn finding(fold: &Fold, step: &StepTrial) -> Option<(String, String)> {
    let whole = |mm: f64| exact::written(mm, 0);
    let (carried_mm, rest, smallest) = match step.effect {
        Effect::Changed => return None,
        Effect::Missed => {
            let why = "nothing is grasped at its pick";
            return Some((why.to_owned(), "pick another point of the cloth".to_owned()));
        }
        Effect::WentBack { .. } if step.planned_mm < 1.0 => {
            let why = "its pick already lies at its place";
            return Some((
                why.to_owned(),
                "leave the step out, or place it elsewhere".to_owned(),
            ));
        }
        Effect::WentBack {
            carried_mm,
            stayed_mm,
            slid_mm,
            smallest,
        } => {
            let rest = if slid_mm < LEAST_SLIDE_MM {
                format!("springs back to {} mm", whole(stayed_mm))
            } else {
                format!("opens again; the whole of it slides {} mm", whole(slid_mm))
            };
            (carried_mm, rest, smallest)
        }
    };
    let why = format!("the cloth is carried {} mm and {rest}", whole(carried_mm));
    let help = match smallest {
        SmallestFold::NoneUpTo { mm } => format!(
            "no fold from here in this direction stays, up to {mm} mm; pick or place another point"
        ),
        SmallestFold::From { mm } => {
            let whole_way_mm = step.planned_mm / fold.fraction;
            let hundredths = (f64::from(mm) / whole_way_mm * 100.0).ceil();
            let cure = if hundredths <= 100.0 {
                let fraction = exact::written(hundredths / 100.0, 2);
                format!("write `at {fraction}` or more")
            } else {
                "choose a place at least that far away".to_owned()
            };
            format!(
                "the smallest fold from here in this direction that this cloth keeps is {mm} mm; {cure}"
            )
        }
    };
    Some((why, help))
}
