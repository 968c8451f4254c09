//! `verify { check NAME { … } else "…" … attempts 3 }`: which answers are rejected, and the messages to the model.

use super::conditions;
use super::context::{Context, Result, declared};
use super::placeholders::{TextPlace, TextScope, template};
use super::quantity::{read, read_whole};
use crate::diag::{Code, Diagnostic, Report, Reported, every};
use crate::lang::verify::{ATTEMPTS, DEFAULT_ATTEMPTS, DEFAULT_RETRIES, OVERLAP, RETRIES, given};
use crate::merge::{Merged, once, unique};
use fab_grammar::ast::{self, Attempts, Expr, Name, Phrase};
use fab_program::Depends;
use fab_program::{Check, Condition, Exhausted, ModelRole, Read, ResultCheck, Verify};

/// The name of the template for the message about a result.
const RESULT: &str = "result";

/// Builds the checks, and adds their messages to the templates.
pub(crate) fn check(merged: &Merged<'_>, context: &mut Context<'_>) -> Result<Verify> {
    let part = merged.verify();
    let checks = merged.checks.iter();
    let checks = every(checks.map(|check| of_answer(check, context)));
    let attempts = part.into_iter().flat_map(|part| part.attempts());
    let attempts = once(attempts, "attempts", |it| it.span(), context.report);
    let count = attempts.map_or(Ok(DEFAULT_ATTEMPTS), |it| {
        read_whole(it.count(), &ATTEMPTS.range, context)
    });
    let relaxed = attempts.map_or(Ok(Vec::new()), |it| relaxed(it, merged, context));
    let picture = attempts.and_then(|it| it.with_picture());
    if let Some(picture) = picture {
        shows_refused(picture, context);
    }
    let results = part.into_iter().flat_map(|part| part.results());
    let results = once(results, "result", |it| it.span(), context.report);
    let result = declared(results, |it| self::result(it, context));
    Ok(Verify {
        checks: checks?,
        attempts: count? as u32,
        relaxed: relaxed?,
        with_picture: picture.is_some(),
        exhausted: match attempts.and_then(|it| it.else_skip()) {
            Some(_) => Exhausted::Skips,
            None => Exhausted::Ends,
        },
        result: result?,
    })
}

// ---- checks of an answer -------------------------------------------------------------------------

fn of_answer(check: ast::Check<'_>, context: &mut Context<'_>) -> Result<Check> {
    let name = check.name();
    if let Some(row) = given(name.text()) {
        let message = format!("every task has a check `{}` already", row.name);
        let help = format!("it refuses {}; choose another name", row.doc);
        context.refuse(Code::DuplicateName, name.span(), message, help);
    }
    let guarded = format!("check {}", name.text());
    let lacks = |what: &str| format!("the check `{}` does not say {what}", name.text());
    let when = declared(check.when(), |expr| condition(expr, context));
    // If the guard has an error, check the rest as if there was a previous action.
    let implies_last =
        |when: &Option<Condition>| when.as_ref().is_some_and(Condition::implies_last);
    let has_last = when.as_ref().map_or(true, implies_last);
    if let (Ok(Some(when)), Some(expr)) = (&when, check.when()) {
        needs_guard(when, has_last, expr, "… when last and …", context);
    }
    let holds = match check.condition() {
        Some(expr) => {
            let holds = condition(expr, context);
            if let Ok(holds) = &holds {
                needs_guard(holds, has_last, expr, &guarded, context);
            }
            holds
        }
        None => {
            let message = lacks("what must hold");
            Err(context.fault(Code::WrongExpression, check.head_span(), message))
        }
    };
    let message = format!("check.{}", name.text());
    let Some(text) = check.message() else {
        let (lacks, help) = (
            lacks("why it refuses"),
            "add `else \"…\"` after the condition",
        );
        return Err(context.refuse(Code::MissingMessage, check.head_span(), lacks, help));
    };
    let scope = TextScope::new(TextPlace::Message, has_last, &guarded);
    let template = template(&message, text, None, scope, context);
    context.templates.push(template);
    Ok(Check {
        name: name.text().to_owned(),
        when: when?,
        holds: holds?,
        message,
    })
}

/// Reports a condition that depends on the previous action, unless there always is one.
fn needs_guard(
    condition: &Condition,
    has_last: bool,
    expr: Expr<'_>,
    guarded: &str,
    context: &mut Context<'_>,
) {
    if condition.uses().last && !has_last {
        context.needs_last(expr.span(), guarded);
    }
}

/// Builds a condition of a check. Emitted verifiers evaluate it too, and they do not know which points are
/// unreachable.
fn condition(expr: Expr<'_>, context: &mut Context<'_>) -> Result<Condition> {
    let condition = conditions::check(expr, context)?;
    if !condition.uses().reach {
        return Ok(condition);
    }
    let message = "`unreachable` cannot be a condition of a check";
    let help = "such points are never offered; a component can mention them: `component NAME when unreachable`";
    Err(context.refuse(Code::WrongExpression, expr.span(), message, help))
}

/// Warns of inherited checks that the task's own `verify` drops without a word. A variant may drop them: it is there to
/// be compared with the task.
pub(crate) fn dropped(merged: &Merged<'_>, report: &mut Report) {
    let dropped = &merged.dropped;
    let (Some(verify), Some((_, first)), None) =
        (merged.verify(), dropped.checks.first(), &merged.variant)
    else {
        return;
    };
    let names = dropped.checks.iter().map(|(name, _)| name.as_str());
    let names: Vec<&str> = names.collect();
    let result = dropped.has_result.then_some("result");
    let parts: Vec<&str> = names.iter().copied().chain(result).collect();
    let message = format!("this `verify` drops the inherited `{}`", parts.join("`, `"));
    let list = names.join(", ");
    let drop =
        format!("to drop checks on purpose, write `without check {list}` beside this `verify`");
    let diagnostic = Diagnostic::new(Code::ChecksDropped, verify.head_span(), message)
        .also(*first, "declared here")
        .help("to keep them, state them in this `verify` too, or write `check` or `override check` in the task itself, without `verify`")
        .help(drop);
    report.remark(diagnostic);
}

// ---- attempts ------------------------------------------------------------------------------------

/// Reports `with picture` if the stage that reads the action asks a model that takes no pictures.
fn shows_refused(with_picture: Phrase<'_>, context: &mut Context<'_>) {
    let stage = context.stages.right().find(|it| it.read == Read::Action);
    if let Some(stage) = stage.filter(|it| it.model == ModelRole::Text) {
        let name = stage.name.clone();
        context.text_model(with_picture.span(), "`with picture`", &name);
    }
}

/// Returns the checks that `then without` removes.
fn relaxed(
    attempts: Attempts<'_>,
    merged: &Merged<'_>,
    context: &mut Context<'_>,
) -> Result<Vec<String>> {
    let twice = unique(attempts.relaxed(), "check", context.report);
    // `then without` may name a check that was already removed.
    let there = attempts
        .relaxed()
        .filter(|name| !merged.checks.is_removed(name.text()));
    let relaxed = there.map(|name| match merged.checks.get(name.text()) {
        Some(_) => Ok(name.text().to_owned()),
        None => Err(not_relaxed(name, merged, context)),
    });
    let relaxed = every(relaxed);
    twice.and(relaxed)
}

/// Reports a name that no check has, or a check that cannot be removed.
fn not_relaxed(name: Name<'_>, merged: &Merged<'_>, context: &mut Context<'_>) -> Reported {
    let new = |message: String| {
        Diagnostic::new(Code::NothingToRemove, name.span(), message).about(name.text())
    };
    if let Some(row) = given(name.text()) {
        let diagnostic = new(format!("`{}` cannot be left out", row.name));
        return context.error(diagnostic.help(format!("{} cannot be executed", row.doc)));
    }
    let diagnostic = new(format!("there is no check `{}` to leave out", name.text()));
    let names = merged.checks.names();
    context.error(diagnostic.suggest(name.text(), names, "the task has no checks"))
}

// ---- the result of a step ------------------------------------------------------------------------

fn result(part: ast::ResultCheck<'_>, context: &mut Context<'_>) -> Result<ResultCheck> {
    let overlap_above = read(part.above(), &OVERLAP.range, context);
    let retries = part.retries();
    let retries = retries.map_or(Ok(DEFAULT_RETRIES), |it| {
        read_whole(it, &RETRIES.range, context)
    });
    let Some(text) = part.message() else {
        let message = "`result` has no message for the model";
        let help = "add `else \"…\"` at its end";
        return Err(context.refuse(Code::MissingMessage, part.span(), message, help));
    };
    let scope = TextScope::new(TextPlace::Result, true, RESULT);
    let template = template(RESULT, text, None, scope, context);
    context.templates.push(template);
    Ok(ResultCheck {
        overlap_above: overlap_above?,
        retries: retries? as u32,
        message: RESULT.to_owned(),
    })
}
