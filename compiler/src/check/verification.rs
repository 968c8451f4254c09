//! `verify { check NAME { … } else "…" … attempts 3 }`.

use super::Context;
use super::quantity::{Measure, Wanted, read, read_whole};
use super::stages::Prompts;
use super::templates::{self, Place, Scope};
use super::{conditions, uses};
use crate::ast;
use crate::diag::{Code, Diagnostic};
use crate::diag::{among, nearest};
use crate::merge::{Merged, once, unique};
use crate::source::Span;
use fab_program::Depends;
use fab_program::verify::{OFFERED, REACHABLE};
use fab_program::{
    Check, Condition, Exhausted, ModelRole, Read, ResultCheck, Stage, Template, Verify,
};

/// Questions per stage and step where none are stated: the paper's.
const DEFAULT_ATTEMPTS: u32 = 3;

/// The most checks of one task.
const MAX_CHECKS: usize = 100;

const ATTEMPTS: Wanted = Wanted {
    measure: Measure::Number,
    range: 1.0..=10.0,
    range_words: "a count from `1` to `10`",
};

const SHARE: Wanted = Wanted {
    measure: Measure::Number,
    range: 0.0..=0.999,
    range_words: "a share from `0` to `0.999`",
};

const RETRIES: Wanted = Wanted {
    measure: Measure::Number,
    range: 1.0..=5.0,
    range_words: "a count from `1` to `5`",
};

/// The name of the template of what is said of a result.
const RESULT: &str = "result";

/// Builds the checks, and adds their messages to the prompts' templates; what is wrong is left out.
pub(crate) fn check(
    merged: &Merged<'_>,
    prompts: &mut Prompts,
    context: &mut Context<'_>,
) -> Verify {
    let mut verify = Verify {
        checks: Vec::new(),
        attempts: DEFAULT_ATTEMPTS,
        relaxed: Vec::new(),
        with_picture: false,
        exhausted: Exhausted::Ends,
        result: None,
    };
    let Some(part) = merged.verify else {
        return verify;
    };
    if let Some(beyond) = part.checks.get(MAX_CHECKS) {
        let message = format!(
            "there are {} checks, at most {MAX_CHECKS} are accepted",
            part.checks.len()
        );
        context.push(Diagnostic::new(Code::OutOfRange, beyond.name.span, message));
        return verify;
    }
    for check in merged.checks.iter() {
        if let Some((check, template)) = self::one(check, context) {
            verify.checks.push(check);
            prompts.templates.push(template);
        }
    }
    let attempts = once(
        &part.attempts,
        "`attempts`",
        |part| part.span,
        context.report,
    );
    if let Some(statement) = attempts {
        if let Some(attempts) = read_whole(&statement.count, &ATTEMPTS, context) {
            verify.attempts = attempts;
        }
        verify.relaxed = relaxed(statement, merged, context);
        if statement.else_skip.is_some() {
            verify.exhausted = Exhausted::Skips;
        }
        if let Some(span) = statement.with_picture {
            verify.with_picture = true;
            needs_eyes(span, &prompts.stages, context);
        }
    }
    let results = once(&part.results, "`result`", |part| part.span, context.report);
    if let Some((result, template)) = results.and_then(|part| self::result(part, context)) {
        verify.result = Some(result);
        prompts.templates.push(template);
    }
    verify
}

/// Builds the check of a step's result.
fn result(part: &ast::ResultCheck, context: &mut Context<'_>) -> Option<(ResultCheck, Template)> {
    let overlap_above = read(&part.above, &SHARE, context);
    let retries = match &part.retries {
        Some(count) => read_whole(count, &RETRIES, context),
        None => Some(1),
    };
    let Some(text) = &part.message else {
        if !part.has_faults {
            let message = "`result` does not say what a model is told before a step is asked again";
            context.push(
                Diagnostic::new(Code::MissingMessage, part.span, message)
                    .help("add `else \"…\"` at its end"),
            );
        }
        return None;
    };
    let scope = Scope {
        place: Place::Result,
        has_last: true,
        guarded: "result",
    };
    let template = templates::template(RESULT, text, None, scope, context)?;
    let check = ResultCheck {
        overlap_above: overlap_above?,
        retries: retries?,
        message: RESULT.to_owned(),
    };
    Some((check, template))
}

/// Reports a picture for a stage whose model sees none.
fn needs_eyes(span: Span, stages: &[Stage], context: &mut Context<'_>) {
    let acts = |stage: &&Stage| matches!(stage.read, Read::Action);
    if let Some(stage) = stages.iter().find(acts)
        && stage.model == ModelRole::Text
    {
        let message = format!(
            "the stage `{}` asks a text model, and a correction would show it a picture",
            stage.name
        );
        context.push(
            Diagnostic::new(Code::PicturesForTextModel, span, message)
                .help("write `model vision` in that stage, or leave out `with picture`"),
        );
    }
}

/// Returns the checks that are left out at last; reports names that no check ever had.
fn relaxed(
    statement: &ast::Attempts,
    merged: &Merged<'_>,
    context: &mut Context<'_>,
) -> Vec<String> {
    unique(statement.relaxed.iter(), "check", context.report);
    let mut relaxed = Vec::new();
    for name in &statement.relaxed {
        let known = || merged.check_names();
        if known().any(|known| known == name.text) {
            relaxed.push(name.text.clone());
        } else if merged.removed_checks.contains(name.text.as_str()) {
            // It is left out from the first question on.
        } else if let OFFERED | REACHABLE = name.text.as_str() {
            let message = format!("`{}` cannot be left out", name.text);
            let help = match name.text == OFFERED {
                true => "what was never offered cannot be carried out",
                false => "what is out of reach cannot be carried out",
            };
            context.push(Diagnostic::new(Code::NothingToRemove, name.span, message).help(help));
        } else if !context.names.may_be_declared(&name.text) {
            let message = format!("there is no check `{}` to leave out", name.text);
            let diagnostic = Diagnostic::new(Code::NothingToRemove, name.span, message);
            context.push(match nearest(&name.text, known()) {
                Some(meant) => diagnostic.meant(name.span, meant),
                None => diagnostic.help(format!("there is {}", among(known()))),
            });
        }
    }
    relaxed
}

/// Builds a condition of a check, which emitted verifiers judge too: these know nothing of what is out of reach.
fn condition(expr: &ast::Expr, context: &mut Context<'_>) -> Option<Condition> {
    let condition = conditions::check(expr, context)?;
    if !condition.uses().reach {
        return Some(condition);
    }
    let message = "what is out of reach is no condition of a check";
    context.push(
        Diagnostic::new(Code::WrongExpression, expr.span, message).help(
            "such points are never offered; what is said of them is a component's: `component NAME when unreachable`",
        ),
    );
    None
}

fn one(check: &ast::Check, context: &mut Context<'_>) -> Option<(Check, Template)> {
    if let OFFERED | REACHABLE = check.name.text.as_str() {
        let message = format!("every task has a check `{}` already", check.name.text);
        let help = match check.name.text == OFFERED {
            true => "it refuses what was not offered; choose another name",
            false => "it refuses what is out of reach; choose another name",
        };
        context.push(Diagnostic::new(Code::DuplicateName, check.name.span, message).help(help));
    }
    // Where the guard is wrong, the rest is checked as if it held.
    let when = check
        .when
        .as_ref()
        .map(|guard| condition(guard, context).unwrap_or(Condition::Last));
    let has_last = when.as_ref().is_some_and(Condition::implies_last);
    let guarded = format!("check {}", check.name.text);
    let mut holds = None;
    if let Some(expr) = &check.condition {
        holds = condition(expr, context);
        if let Some(condition) = &holds
            && condition.uses().last
            && !has_last
        {
            uses::needs_last(expr.span, &guarded, context);
            holds = None;
        }
    }
    if let (Some(expr), Some(when)) = (&check.when, &when)
        && when.uses().last
        && !has_last
    {
        uses::needs_last(expr.span, "… when last and …", context);
    }
    let Some(text) = &check.message else {
        if !check.has_faults {
            let message = format!(
                "the check `{}` does not say why it refuses",
                check.name.text
            );
            context.push(
                Diagnostic::new(Code::MissingMessage, check.span, message)
                    .help("add `else \"…\"` behind the condition"),
            );
        }
        return None;
    };
    let name = format!("check.{}", check.name.text);
    let scope = Scope {
        place: Place::Message,
        has_last,
        guarded: &guarded,
    };
    let template = templates::template(&name, text, None, scope, context);
    let check = Check {
        name: check.name.text.clone(),
        when,
        holds: holds?,
        message: name,
    };
    Some((check, template?))
}
