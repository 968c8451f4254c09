//! `verify { check NAME { … } else "…" … attempts 3 }`.

use super::Context;
use super::conditions;
use super::quantity::{Measure, Wanted, read_whole};
use super::templates::{self, Place};
use crate::ast;
use crate::diag::{Code, Diagnostic};
use crate::merge::{Merged, once, unique};
use crate::program::{ActionField, Check, Template, Verify};
use crate::verify::OFFERED;

/// Questions per stage and step where none are stated: the paper's.
const DEFAULT_ATTEMPTS: u32 = 3;

/// The most checks of one task.
const MAX_CHECKS: usize = 100;

const ATTEMPTS: Wanted = Wanted {
    measure: Measure::Number,
    range: 1.0..=10.0,
    range_words: "a count from `1` to `10`",
};

/// Builds the checks, and adds their messages to `templates`; what is wrong is left out.
pub(crate) fn check(
    merged: &Merged<'_>,
    actions: &[ActionField],
    templates: &mut Vec<Template>,
    context: &mut Context<'_>,
) -> Verify {
    let mut verify = Verify {
        checks: Vec::new(),
        attempts: DEFAULT_ATTEMPTS,
        relaxed: Vec::new(),
    };
    let Some(part) = merged.verify else {
        return verify;
    };
    unique(
        part.checks.iter().map(|check| &check.name),
        "check",
        context.report,
    );
    if let Some(beyond) = part.checks.get(MAX_CHECKS) {
        let message = format!(
            "there are {} checks, at most {MAX_CHECKS} are accepted",
            part.checks.len()
        );
        context.push(Diagnostic::new(Code::OutOfRange, beyond.name.span, message));
        return verify;
    }
    for check in &part.checks {
        if let Some((check, template)) = self::one(check, actions, context) {
            verify.checks.push(check);
            templates.push(template);
        }
    }
    if let Some(statement) = once(
        &part.attempts,
        "`attempts`",
        |part| part.span,
        context.report,
    ) && let Some(attempts) = read_whole(&statement.value, &ATTEMPTS, context)
    {
        verify.attempts = attempts;
    }
    verify
}

fn one(
    check: &ast::Check,
    actions: &[ActionField],
    context: &mut Context<'_>,
) -> Option<(Check, Template)> {
    if check.name.text == OFFERED {
        let message = format!("every task has a check `{OFFERED}` already");
        context.push(
            Diagnostic::new(Code::DuplicateName, check.name.span, message)
                .help("it refuses points that were not offered; choose another name"),
        );
    }
    let holds = check
        .condition
        .as_ref()
        .and_then(|condition| conditions::check(condition, context));
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
    let template = templates::template(&name, text, Place::Message, actions, context);
    let check = Check {
        name: check.name.text.clone(),
        when: None,
        holds: holds?,
        message: name,
    };
    Some((check, template?))
}
