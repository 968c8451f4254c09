//! Reports values that depend on an action that may not exist.

use super::context::Context;
use crate::diag::{Code, Diagnostic, Reported};
use fab_grammar::Span;

/// Reports a value that depends on the previous action if there may be none.
pub(crate) fn needs_last(span: Span, guarded: &str, context: &mut Context<'_, '_>) -> Reported {
    let written = context.written(span);
    let message = format!("`{written}` is not known in the first step");
    let diagnostic = Diagnostic::new(Code::NeedsLast, span, message);
    context.error(diagnostic.help(format!("write `{guarded} when last`")))
}

/// Reports a value that depends on the action before one is proposed.
pub(crate) fn needs_action(span: Span, context: &mut Context<'_, '_>) -> Reported {
    let written = context.written(span);
    let message = format!("`{written}` is known only when an action is proposed");
    let diagnostic = Diagnostic::new(Code::NotYetKnown, span, message);
    context.error(diagnostic.help("fields of the action can be used in checks and their messages"))
}
