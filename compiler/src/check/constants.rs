//! `const reach = 0.23edge`: quantities with a name.

use super::Context;
use crate::ast::{Expr, ExprKind};
use crate::diag::{Code, Diagnostic};
use crate::merge::Merged;

/// Reports constants that are no quantities.
pub(crate) fn check(merged: &Merged<'_>, context: &mut Context<'_>) {
    for constant in merged.constants.iter() {
        if !matches!(constant.value.kind, ExprKind::Quantity { .. }) {
            let found = context.written(constant.value.span);
            let message = format!("a constant is a number and its unit, found `{found}`");
            context.push(
                Diagnostic::new(Code::WrongForm, constant.value.span, message)
                    .help(format!("write `const {} = 20mm`", constant.name.text)),
            );
        }
    }
}

/// Returns what an expression stands for: a constant's value for its name, else the expression itself.
pub(super) fn resolved<'e>(expr: &'e Expr, context: &Context<'e>) -> &'e Expr {
    if let ExprKind::Name(name) = &expr.kind
        && let Some(constant) = context.constants.get(name.as_str())
        && matches!(constant.value.kind, ExprKind::Quantity { .. })
    {
        return &constant.value;
    }
    expr
}

/// Returns whether a name is a constant whose own declaration is wrong, and reported.
pub(super) fn is_broken(expr: &Expr, context: &Context<'_>) -> bool {
    matches!(&expr.kind, ExprKind::Name(name) if context.constants.get(name.as_str())
        .is_some_and(|constant| !matches!(constant.value.kind, ExprKind::Quantity { .. })))
}
