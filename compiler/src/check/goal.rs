//! `goal particle_distance < 40mm` and `horizon 3`: when a rollout ends.

use super::context::{Context, Declared};
use super::quantity::{read, read_whole};
use super::untouched;
use crate::diag::{Code, Diagnostic, Reported, among};
use crate::lang::goal::{METRICS, MetricRow, STEPS};
use crate::merge::Merged;
use fab_grammar::ast::{Expr, Name, Statement};
use fab_program::{Comparison, Goal, Metric, Sequence, Subgoals, exact};

/// Builds the goal.
pub(crate) fn check<'a>(
    statement: Statement<'a>,
    merged: &Merged<'a>,
    experts: &Result<Vec<Sequence>, Reported>,
    context: &mut Context<'a, '_>,
) -> Result<Goal, Reported> {
    let form = || format!("write {}", among(METRICS.iter().map(|row| row.example)));
    let Expr::Compare(compare) = statement.value() else {
        let message = "expected a measure and its limit";
        let diagnostic = Diagnostic::new(Code::WrongForm, statement.value().span(), message);
        return Err(context.error(diagnostic.help(form())));
    };
    let Expr::Name(name) = compare.left() else {
        let message = "expected the name of a measure";
        let diagnostic = Diagnostic::new(Code::WrongForm, compare.left().span(), message);
        return Err(context.error(diagnostic.help(form())));
    };
    let Some(row) = METRICS
        .iter()
        .find(|row| row.metric.as_str() == name.text())
    else {
        return Err(context.unknown(
            "measure",
            name,
            METRICS.iter().map(|row| row.metric.as_str()),
        ));
    };
    let is = comparison(row, compare.sign(), context);
    let limit = read(compare.right(), &row.limit, context);
    let goal = Goal {
        metric: row.metric,
        is: is?,
        limit: limit?,
    };
    let experts = experts.as_deref().map_err(|reported| *reported)?;
    has_experts(&goal, statement, merged, experts, context)?;
    if let Ok(Some(cloth)) = &context.cloth
        && let Some(score) = untouched::score(&goal, cloth, experts)
        && goal.is_met(score)
    {
        let written = match goal.metric {
            Metric::ParticleDistance => format!("about {}mm", exact::written(score * 1000.0, 0)),
            _ => exact::written(score, 2),
        };
        let message = format!("an untouched cloth meets this goal: it scores {written}");
        let diagnostic = Diagnostic::new(Code::GoalMetAtStart, statement.value().span(), message);
        context.remark(diagnostic.help("demand more, so that a rollout that does nothing fails"));
    }
    Ok(goal)
}

/// Returns the comparison if it points the way in which the measure improves.
fn comparison(
    row: &MetricRow,
    sign: Name<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Comparison, Reported> {
    let mut reached = row.reached.into_iter();
    if let Some(comparison) = reached.find(|it| it.sign() == sign.text()) {
        return Ok(comparison);
    }
    let right = row.reached[0].sign();
    let side = if right == "<" { "below" } else { "above" };
    let message = format!(
        "`{}` is reached {side} its limit, not by `{}`",
        row.metric.as_str(),
        sign.text()
    );
    let diagnostic = Diagnostic::new(Code::WrongForm, sign.span(), message);
    Err(context.error(
        diagnostic
            .help(format!("write `{right}`"))
            .edit(sign.span(), right),
    ))
}

/// Reports a goal of distance without expert results to measure to.
fn has_experts(
    goal: &Goal,
    statement: Statement<'_>,
    merged: &Merged<'_>,
    experts: &[Sequence],
    context: &mut Context<'_, '_>,
) -> Result<(), Reported> {
    let are_images = merged.subgoals.is_none_or(|part| {
        part.images().next().is_some() && part.demonstrations().next().is_none()
    });
    let is_meant_to_run = merged.subgoals.is_some()
        || !merged.stages.is_empty() && merged.statement("cloth").is_some();
    let has_none = experts.is_empty() && merged.experts.is_none();
    if goal.metric != Metric::ParticleDistance || !has_none || !are_images || !is_meant_to_run {
        return Ok(());
    }
    let message = "there is no expert's result to compare with";
    let span = statement.value().span();
    let diagnostic = Diagnostic::new(Code::NothingToCompare, span, message);
    Err(context.error(diagnostic.help("name `experts`: images do not say how the cloth ends")))
}

/// Returns the most steps of a rollout: as stated, or else as many as the subgoals show.
pub(crate) fn horizon<'a>(
    merged: &Merged<'a>,
    subgoals: &Declared<Subgoals>,
    context: &mut Context<'a, '_>,
) -> Declared<u32> {
    let n_shown = subgoals
        .as_ref()
        .map(|it| it.as_ref().map(|it| it.steps() as u32));
    let Some(statement) = merged.statement("horizon") else {
        let is_meant_to_run = merged.statement("cloth").is_some() && !merged.stages.is_empty();
        if merged.subgoals.is_none() && is_meant_to_run && merged.missing_base.is_none() {
            let name = merged.task.name();
            let message = format!("`{}` has neither subgoals nor a `horizon`", name.text());
            let diagnostic = Diagnostic::new(Code::NoHorizon, name.span(), message)
                .help("write `horizon 10` for at most ten actions, or show `subgoals`");
            return Err(context.missing(merged.is_damaged, name.span().file, diagnostic));
        }
        return n_shown.map_err(|reported| *reported);
    };
    let stated = read_whole(statement.value(), &STEPS, context)? as u32;
    let Ok(Some(n_shown)) = n_shown else {
        return Ok(Some(stated));
    };
    let steps = |count: u32| match count {
        1 => "1 step".to_owned(),
        _ => format!("{count} steps"),
    };
    let message = format!(
        "the horizon is {}, the subgoals show {}",
        steps(stated),
        steps(n_shown)
    );
    let place = merged
        .subgoals
        .map_or(statement.span(), |part| part.head_span());
    let new = |code| Diagnostic::new(code, statement.span(), message).also(place, "the subgoals");
    if stated > n_shown {
        let help = format!("write `horizon {n_shown}`, or show more");
        return Err(context.error(new(Code::HorizonTooLong).help(help)));
    }
    if stated < n_shown {
        context.remark(new(Code::HorizonTooShort));
    }
    Ok(Some(stated))
}
