//! `goal particle_distance < 40mm` and `horizon 3`.

use super::Context;
use super::quantity::{Measure, Wanted, read, read_whole};
use crate::ast::{ExprKind, Ident, Statement};
use crate::diag::{Code, Diagnostic};
use crate::merge::Merged;
use crate::program::{Comparison, Goal, Metric, Sequence, Subgoals};

const LIMIT: Wanted = Wanted {
    measure: Measure::Length,
    range: 1e-6..=10.0,
    range_words: "a distance from `0.001mm` to `10m`",
};

const STEPS: Wanted = Wanted {
    measure: Measure::Number,
    range: 1.0..=100.0,
    range_words: "a number of steps from `1` to `100`",
};

/// Builds the goal.
pub(crate) fn check(
    statement: &Statement,
    merged: &Merged<'_>,
    experts: &[Sequence],
    context: &mut Context<'_>,
) -> Option<Goal> {
    let form = "write `goal particle_distance < 40mm`";
    let ExprKind::Compare { left, sign, right } = &statement.value.kind else {
        context.push(
            Diagnostic::new(
                Code::WrongForm,
                statement.value.span,
                "expected a measure and its limit",
            )
            .help(form),
        );
        return None;
    };
    match &left.kind {
        ExprKind::Name(name) if name == "particle_distance" => {}
        ExprKind::Name(name) => {
            context.unknown(
                "measure",
                &Ident {
                    text: name.clone(),
                    span: left.span,
                },
                ["particle_distance"],
            );
            return None;
        }
        _ => {
            context.push(
                Diagnostic::new(Code::WrongForm, left.span, "expected the name of a measure")
                    .help(form),
            );
            return None;
        }
    }
    if sign.text != "<" {
        let message = format!("a goal is reached below its limit, not by `{}`", sign.text);
        context.push(
            Diagnostic::new(Code::WrongForm, sign.span, message)
                .help("write `<`")
                .edit(sign.span, "<"),
        );
        return None;
    }
    let below_m = read(right, &LIMIT, context)?;
    let brings_images = merged
        .subgoals
        .is_some_and(|part| !part.images.is_empty() && part.demonstrate.is_empty());
    if experts.is_empty() && merged.experts.is_none() && brings_images {
        context.push(
            Diagnostic::new(
                Code::NothingToCompare,
                statement.value.span,
                "there is no expert's result to compare with",
            )
            .help("name `experts`: images do not say how the cloth ends"),
        );
    }
    Some(Goal {
        metric: Metric::ParticleDistance,
        is: Comparison::Less,
        limit: below_m,
    })
}

/// Returns the most steps of a rollout: as stated, else as many as the subgoals show.
pub(crate) fn horizon(
    merged: &Merged<'_>,
    subgoals: Option<&Subgoals>,
    context: &mut Context<'_>,
) -> Option<u32> {
    let shown = subgoals.map(|subgoals| subgoals.steps() as u32);
    let Some(statement) = merged.horizon else {
        return shown;
    };
    let stated = read_whole(&statement.value, &STEPS, context)?;
    let Some(shown) = shown else {
        return Some(stated);
    };
    let steps = |count: u32| {
        if count == 1 {
            "1 step".to_owned()
        } else {
            format!("{count} steps")
        }
    };
    let message = format!(
        "the horizon is {}, the subgoals show {}",
        steps(stated),
        steps(shown)
    );
    let place = merged.subgoals.map_or(statement.span, |part| part.span);
    if stated > shown {
        context.push(
            Diagnostic::new(Code::HorizonTooLong, statement.span, message)
                .also(place, "the subgoals")
                .help(format!("write `horizon {shown}`, or show more")),
        );
    } else if stated < shown {
        context.push(
            Diagnostic::new(Code::HorizonTooShort, statement.span, message)
                .also(place, "the subgoals"),
        );
    }
    Some(stated)
}
