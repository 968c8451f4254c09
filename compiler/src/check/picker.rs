//! `picker drop`.

use super::Context;
use crate::ast::{ExprKind, Ident, Statement};
use crate::diag::{Code, Diagnostic};
use fab_program::Picker;

/// Reads how the cloth is carried and let go.
pub(crate) fn check(statement: &Statement, context: &mut Context<'_>) -> Option<Picker> {
    let value = &statement.value;
    let ExprKind::Name(name) = &value.kind else {
        let found = context.written(value.span);
        let message = format!("expected `put_down` or `drop`, found `{found}`");
        context.push(
            Diagnostic::new(Code::WrongForm, value.span, message)
                .help("`put_down` lowers the cloth before it lets go, `drop` lets it fall"),
        );
        return None;
    };
    let known = Picker::NAMES.iter().find(|(known, _)| known == name);
    if known.is_none() {
        let name = Ident {
            text: name.clone(),
            span: value.span,
        };
        context.unknown("picker", &name, Picker::NAMES.map(|(known, _)| known));
    }
    known.map(|(_, picker)| *picker)
}
