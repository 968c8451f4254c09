//! `picker drop`, `picker put_down(lift: 100mm)`: how the gripper carries and releases the cloth.

use super::context::{Context, Result};
use super::expressions::{made, name_of};
use crate::diag::{Code, Diagnostic};
use crate::lang::calls::PICKERS;
use crate::merge::Merged;
use fab_grammar::ast::{Expr, Statement};
use fab_program::{Manner, Picker};

/// Reads how the gripper carries and releases the cloth.
pub(crate) fn check(
    statement: Statement<'_>,
    context: &mut Context<'_>,
) -> Result<(Picker, Manner)> {
    let written = statement.value();
    let Expr::Call(_) = written else {
        let name = name_of(written, "picker", Picker::WORDS, context)?;
        let picker = Picker::from_word(name).unwrap_or_default();
        return Ok((picker, Manner::default()));
    };
    let (picker, ..) = made("picker", written, PICKERS, context)?;
    Ok(picker)
}

/// Reports a field that the picker states for every action, and that the model is asked for too.
pub(crate) fn stated_once(manner: &Manner, merged: &Merged<'_>, context: &mut Context<'_>) {
    let Some(picker) = merged.statement("picker") else {
        return;
    };
    let fields = merged.actions().into_iter().flat_map(|part| part.fields());
    for field in fields.map(|field| field.name()) {
        let name = field.text();
        if manner.stated().any(|(stated, _)| stated == name) {
            let message = format!("`{name}` is offered to the model, and the picker states it");
            let help = format!("remove the field, or write the picker without `{name}`");
            let diagnostic = Diagnostic::new(Code::DuplicateName, field.span(), message)
                .also(picker.value().span(), "stated here for every action")
                .help(help);
            context.error(diagnostic);
        }
    }
}
