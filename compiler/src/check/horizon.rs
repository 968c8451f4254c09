//! `horizon 3`: the most actions of a rollout.

use super::context::{Context, Declared};
use super::quantity::read_whole;
use crate::diag::{Code, Diagnostic};
use crate::lang::goal::STEPS;
use crate::merge::Merged;

/// Returns the most steps of a rollout: the stated number, or by default as many as the subgoals show.
pub(crate) fn check(merged: &Merged<'_>, context: &mut Context<'_>) -> Declared<u32> {
    let subgoals = context.subgoals.as_ref().map_err(|reported| *reported);
    let n_shown = subgoals.map(|it| it.as_ref().map(|it| it.steps() as u32));
    let Some(statement) = merged.statement("horizon") else {
        let is_meant_to_run = merged.statement("cloth").is_some() && !merged.stages.is_empty();
        if merged.subgoals().is_none() && is_meant_to_run {
            let name = merged.task.name();
            let message = format!("`{}` has neither subgoals nor a `horizon`", name.text());
            let help = "write `horizon 10` for at most ten actions, or show `subgoals`";
            return Err(context.refuse(Code::NoHorizon, name.span(), message, help));
        }
        return n_shown;
    };
    let stated = read_whole(statement.value(), &STEPS, context)? as u32;
    let Ok(Some(n_shown)) = n_shown else {
        return Ok(Some(stated));
    };
    let message = format!("the horizon is {stated}, the subgoals show {n_shown}");
    let place = merged
        .subgoals()
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
