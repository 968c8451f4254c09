//! Reports what a value or a condition depends on where that is not known yet.

use super::Context;
use crate::diag::{Code, Diagnostic};
use crate::source::Span;

/// Reports a dependence on the action before where there may be none.
pub(crate) fn needs_last(span: Span, guarded: &str, context: &mut Context<'_>) {
    let written = context.written(span);
    let message = format!("`{written}` is not known in the first step");
    context.push(
        Diagnostic::new(Code::NeedsLast, span, message)
            .help(format!("write `{guarded} when last`")),
    );
}

/// Reports a dependence on the action where none is proposed yet.
pub(crate) fn needs_action(span: Span, context: &mut Context<'_>) {
    let written = context.written(span);
    let message = format!("`{written}` is known only when an action is proposed");
    context.push(
        Diagnostic::new(Code::NotYetKnown, span, message)
            .help("fields of the action can be written in checks and their messages"),
    );
}
