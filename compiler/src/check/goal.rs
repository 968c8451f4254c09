//! `goal particle_distance < 40mm` and `horizon 3`.

use super::Context;
use super::quantity::{Measure, Wanted, read, read_whole};
use super::untouched;
use crate::ast::{Expr, ExprKind, Ident, Statement};
use crate::diag::{Code, Diagnostic};
use crate::merge::Merged;
use fab_program::exact;
use fab_program::{Comparison, Goal, Metric, Sequence, Subgoals};

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

const FRACTION: Wanted = Wanted {
    measure: Measure::Number,
    range: -1.0..=1.2,
    range_words: "a fraction up to `1.2`",
};

const METRICS: [Metric; 3] = [
    Metric::ParticleDistance,
    Metric::Coverage,
    Metric::NormalizedImprovement,
];

const FORM: &str = "write `goal particle_distance < 40mm`, `goal coverage > 0.9` or `goal normalized_improvement > 0.95`";

/// Builds the goal.
pub(crate) fn check(
    statement: &Statement,
    merged: &Merged<'_>,
    experts: &[Sequence],
    context: &mut Context<'_>,
) -> Option<Goal> {
    let ExprKind::Compare { left, sign, right } = &statement.value.kind else {
        context.push(
            Diagnostic::new(
                Code::WrongForm,
                statement.value.span,
                "expected a measure and its limit",
            )
            .help(FORM),
        );
        return None;
    };
    let metric = metric(left, context)?;
    let is = direction(metric, sign, context)?;
    let wanted = match metric {
        Metric::ParticleDistance => &LIMIT,
        Metric::Coverage | Metric::NormalizedImprovement => &FRACTION,
    };
    let goal = Goal {
        metric,
        is,
        limit: read(right, wanted, context)?,
    };
    let brings_images = merged
        .subgoals
        .is_none_or(|part| !part.images.is_empty() && part.demonstrate.is_empty());
    if metric == Metric::ParticleDistance
        && experts.is_empty()
        && merged.experts.is_none()
        && brings_images
        && (merged.subgoals.is_some() || !merged.stages.is_empty() && merged.cloth.is_some())
    {
        context.push(
            Diagnostic::new(
                Code::NothingToCompare,
                statement.value.span,
                "there is no expert's result to compare with",
            )
            .help("name `experts`: images do not say how the cloth ends"),
        );
    }
    if let Some(cloth) = &context.cloth
        && let Some(score) = untouched::score(&goal, cloth, experts)
        && goal.is_met(score)
    {
        let written = match metric {
            Metric::ParticleDistance => format!("about {}mm", exact::written(score * 1000.0, 0)),
            _ => exact::written(score, 2),
        };
        let message = format!("an untouched cloth meets this goal: it scores {written}");
        context.push(
            Diagnostic::new(Code::GoalMetAtStart, statement.value.span, message)
                .help("demand more, so that a rollout that does nothing fails"),
        );
    }
    Some(goal)
}

fn metric(expr: &Expr, context: &mut Context<'_>) -> Option<Metric> {
    let ExprKind::Name(name) = &expr.kind else {
        context.push(
            Diagnostic::new(Code::WrongForm, expr.span, "expected the name of a measure")
                .help(FORM),
        );
        return None;
    };
    let found = METRICS.into_iter().find(|metric| metric.as_str() == name);
    if found.is_none() {
        let name = Ident {
            text: name.clone(),
            span: expr.span,
        };
        context.unknown("measure", &name, METRICS.map(Metric::as_str));
    }
    found
}

/// Returns the comparison, if it is the way in which the measure gets better.
fn direction(metric: Metric, sign: &Ident, context: &mut Context<'_>) -> Option<Comparison> {
    let (wanted, words, right) = match metric {
        Metric::ParticleDistance => (["<", "<="], "below", "<"),
        Metric::Coverage | Metric::NormalizedImprovement => ([">", ">="], "above", ">"),
    };
    if !wanted.contains(&sign.text.as_str()) {
        let name = metric.as_str();
        let message = format!(
            "`{name}` is reached {words} its limit, not by `{}`",
            sign.text
        );
        context.push(
            Diagnostic::new(Code::WrongForm, sign.span, message)
                .help(format!("write `{right}`"))
                .edit(sign.span, right),
        );
        return None;
    }
    Some(match sign.text.as_str() {
        "<" => Comparison::Less,
        "<=" => Comparison::AtMost,
        ">" => Comparison::Greater,
        _ => Comparison::AtLeast,
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
        let is_runnable = merged.cloth.is_some() && !merged.stages.is_empty();
        if merged.subgoals.is_none() && is_runnable && !merged.has_faults && !merged.is_broken {
            let name = &merged.task.name;
            let message = format!("`{}` has neither subgoals nor a `horizon`", name.text);
            context.push(
                Diagnostic::new(Code::NoHorizon, name.span, message)
                    .help("write `horizon 10` for at most ten actions, or show `subgoals`"),
            );
        }
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
