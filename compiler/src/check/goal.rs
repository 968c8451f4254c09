//! `goal particle_distance < 40mm`: what counts as done.

use super::conditions;
use super::context::{Context, Result};
use super::quantity::read;
use super::untouched_score;
use crate::diag::{Code, Diagnostic, among};
use crate::lang::conditions::Sign;
use crate::lang::goal::{METRICS, MetricRow};
use crate::merge::Merged;
use fab_grammar::Span;
use fab_grammar::ast::{Expr, Name, Statement};
use fab_program::{Comparison, Goal, Metric, Sequence, exact};

/// Builds the goal.
pub(crate) fn check(
    statement: Statement<'_>,
    merged: &Merged<'_>,
    experts: &Result<Vec<Sequence>>,
    context: &mut Context<'_>,
) -> Result<Goal> {
    let form = || format!("write {}", among(METRICS.iter().map(|row| row.example)));
    let (compare, name) = match statement.value() {
        Expr::Compare(compare) if let Expr::Name(name) = compare.left() => (compare, name),
        other => {
            let message = "expected a measure and its limit";
            return Err(context.refuse(Code::WrongForm, other.span(), message, form()));
        }
    };
    let row = context.row("measure", name, METRICS, |row| row.metric.as_str())?;
    let is = comparison(row, compare.sign(), context);
    let limit = read(compare.right(), &row.limit, context);
    let goal = Goal {
        metric: row.metric,
        is: is?,
        limit: limit?,
    };
    let experts = experts.as_deref().map_err(|reported| *reported)?;
    let span = statement.value().span();
    has_experts(&goal, span, merged, experts, context);
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
        let help = "set a stricter limit, so that a rollout that does nothing fails";
        context.warn(Code::GoalMetAtStart, span, message, help);
    }
    Ok(goal)
}

/// Returns the comparison if it has the direction in which the measure improves.
fn comparison(row: &MetricRow, sign: Name<'_>, context: &mut Context<'_>) -> Result<Comparison> {
    if let Sign::Order(is) = conditions::sign(sign, context)?
        && row.reached.contains(&is)
    {
        return Ok(is);
    }
    let right = row.reached[0].sign();
    let side = if right == "<" { "below" } else { "above" };
    let (measure, sign, span) = (row.metric.as_str(), sign.text(), sign.span());
    let message =
        format!("`{measure}` must be {side} its limit, so `{sign}` is the wrong way round");
    // Perhaps the sign is right, and the measure is not the one that was meant.
    let diagnostic = Diagnostic::new(Code::WrongForm, span, message)
        .help(format!("write `{right}`"))
        .likely(span, right);
    Err(context.error(diagnostic))
}

/// Reports a distance goal without an expert result to measure against.
fn has_experts(
    goal: &Goal,
    span: Span,
    merged: &Merged<'_>,
    experts: &[Sequence],
    context: &mut Context<'_>,
) {
    let are_images = merged.subgoals().is_none_or(|part| {
        part.images().next().is_some() && part.demonstrations().next().is_none()
    });
    let is_meant_to_run = merged.subgoals().is_some()
        || !merged.stages.is_empty() && merged.statement("cloth").is_some();
    let has_none = experts.is_empty() && merged.experts().is_none();
    if goal.metric == Metric::ParticleDistance && has_none && are_images && is_meant_to_run {
        let message = "there is no expert result to compare with";
        let help = "name `experts`: images do not say how the cloth ends";
        context.refuse(Code::NothingToCompare, span, message, help);
    }
}
