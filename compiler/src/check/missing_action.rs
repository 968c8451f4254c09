//! Reports values that depend on an action that may not exist.

use super::context::Context;
use crate::diag::{Code, Reported};
use fab_grammar::Span;

/// Reports a value that depends on the previous action if there may be none.
pub(crate) fn needs_last(span: Span, guarded: &str, context: &mut Context<'_>) -> Reported {
    let message = format!("`{}` is not known in the first step", context.written(span));
    let help = format!("write `{guarded} when last`");
    context.refuse(Code::NeedsLast, span, message, help)
}

/// Reports a value that depends on the action before one is proposed.
pub(crate) fn needs_action(span: Span, context: &mut Context<'_>) -> Reported {
    let written = context.written(span);
    let message = format!("`{written}` is known only when an action is proposed");
    let help = "fields of the action can be used in checks and their messages";
    context.refuse(Code::NotYetKnown, span, message, help)
}
