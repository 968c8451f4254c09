//! `goal particle_distance < 40mm`: what counts as done.

use super::conditions::not_a_sign;
use super::context::Context;
use super::quantity::read;
use super::untouched_score;
use crate::diag::{Code, Diagnostic, Reported, among};
use crate::lang::conditions::SIGNS;
use crate::lang::goal::{METRICS, MetricRow};
use crate::merge::Merged;
use fab_grammar::ast::{Expr, Name, Statement};
use fab_program::{Comparison, Goal, Metric, Sequence, exact};

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
        && let Some(score) = untouched_score::score(&goal, cloth, experts)
        && goal.is_met(score)
    {
        let written = if goal.metric == Metric::ParticleDistance {
            format!("about {}mm", exact::written(score * 1000.0, 0))
        } else {
            exact::written(score, 2)
        };
        let message = format!("an untouched cloth meets this goal: it scores {written}");
        let diagnostic = Diagnostic::new(Code::GoalMetAtStart, statement.value().span(), message);
        let help = "set a stricter limit, so that a rollout that does nothing fails";
        context.remark(diagnostic.help(help));
    }
    Ok(goal)
}

/// Returns the comparison if it has the direction in which the measure improves.
fn comparison(
    row: &MetricRow,
    sign: Name<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Comparison, Reported> {
    let mut reached = row.reached.into_iter();
    if let Some(comparison) = reached.find(|it| it.sign() == sign.text()) {
        return Ok(comparison);
    }
    let mut signs = SIGNS.iter();
    if let Some(meant) = signs.find(|row| row.misspelling == Some(sign.text())) {
        return Err(context.error(not_a_sign(sign, meant.name)));
    }
    let right = row.reached[0].sign();
    let side = if right == "<" { "below" } else { "above" };
    let message = format!(
        "`{}` must be {side} its limit, so `{}` is the wrong way round",
        row.metric.as_str(),
        sign.text()
    );
    let diagnostic = Diagnostic::new(Code::WrongForm, sign.span(), message);
    Err(context.error(
        diagnostic
            .help(format!("write `{right}`"))
            // Perhaps the sign is right, and the measure is not the one that was meant.
            .likely(sign.span(), right),
    ))
}

/// Reports a distance goal without an expert result to measure against.
fn has_experts(
    goal: &Goal,
    statement: Statement<'_>,
    merged: &Merged<'_>,
    experts: &[Sequence],
    context: &mut Context<'_, '_>,
) -> Result<(), Reported> {
    let are_images = merged.subgoals().is_none_or(|part| {
        part.images().next().is_some() && part.demonstrations().next().is_none()
    });
    let is_meant_to_run = merged.subgoals().is_some()
        || !merged.stages.is_empty() && merged.statement("cloth").is_some();
    let has_none = experts.is_empty() && merged.experts().is_none();
    if goal.metric != Metric::ParticleDistance || !has_none || !are_images || !is_meant_to_run {
        return Ok(());
    }
    let message = "there is no expert result to compare with";
    let span = statement.value().span();
    let diagnostic = Diagnostic::new(Code::NothingToCompare, span, message);
    let diagnostic = diagnostic.help("name `experts`: images do not say how the cloth ends");
    Err(context.error(diagnostic))
}
