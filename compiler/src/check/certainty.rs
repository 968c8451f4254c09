//! Warns of checks that can never pass or never fail, and of components whose condition never or always holds.

use crate::diag::{Code, Diagnostic};
use crate::merge::Merged;
use crate::proof::certain::{never, reason};
use fab_grammar::Span;
use fab_program::{Condition, Program};

/// Returns a warning for each condition of a program whose result is certain.
pub(super) fn check(program: &Program, merged: &Merged<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for check in &program.verify.checks {
        let Some(part) = merged.checks.get(&check.name) else {
            continue;
        };
        let (when, holds) = (check.when.as_ref(), &check.holds);
        let guard = part.when().map(|expr| expr.span());
        let condition = part.condition().map(|expr| expr.span());
        let both = |passes| -> Vec<(&Condition, bool)> {
            let when = when.map(|when| (when, true));
            when.into_iter().chain([(holds, passes)]).collect()
        };
        let name = format!("the check `{}`", check.name);
        match (when, guard, condition) {
            (Some(when), Some(span), _) if never(&[(when, true)], program) => {
                found.push(warning(
                    format!("{name} never applies"),
                    (when, true),
                    span,
                    "correct the condition after `when`, or remove the check",
                    program,
                ));
            }
            (_, _, Some(span)) if never(&both(true), program) => {
                found.push(warning(
                    format!("{name} can never pass"),
                    (holds, true),
                    span,
                    "every answer would be refused; correct the condition, or remove the check",
                    program,
                ));
            }
            (_, _, Some(span)) if never(&both(false), program) => {
                found.push(warning(
                    format!("{name} can never fail"),
                    (holds, false),
                    span,
                    "no answer would be refused; correct the condition, or remove the check",
                    program,
                ));
            }
            _ => {}
        }
    }
    for template in &program.templates {
        let component = merged.components.get(&template.name);
        let guard = component.and_then(|component| component.when());
        let (Some(when), Some(guard)) = (&template.when, guard) else {
            continue;
        };
        let name = format!("the component `{}`", template.name);
        if never(&[(when, true)], program) {
            found.push(warning(
                format!("{name} is never said"),
                (when, true),
                guard.span(),
                "correct the condition, or remove the component",
                program,
            ));
        } else if never(&[(when, false)], program) {
            found.push(warning(
                format!("{name} is always said"),
                (when, false),
                guard.span(),
                "correct the condition, or remove it together with `when`",
                program,
            ));
        }
    }
    found
}

fn warning(
    what: String,
    condition: (&Condition, bool),
    span: Span,
    help: &str,
    program: &Program,
) -> Diagnostic {
    let message = match reason(condition, program) {
        Some(reason) => format!("{what}: {reason}"),
        None => what,
    };
    Diagnostic::new(Code::CertainCondition, span, message).help(help)
}
