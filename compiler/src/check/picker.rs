//! `picker drop`, `picker put_down(lift: 100mm)`: how the gripper carries and releases the cloth.

use super::context::{Context, Result};
use super::expressions::{made, name_of};
use crate::diag::{Code, Diagnostic};
use crate::lang::calls::PICKERS;
use crate::merge::Merged;
use fab_grammar::ast::{Expr, Statement};
use fab_program::{ActionField, Manner, Picker};

/// Reads how the gripper carries and releases the cloth.
pub(crate) fn check(
    statement: Statement<'_>,
    context: &mut Context<'_>,
) -> Result<(Picker, Manner)> {
    let written = statement.value();
    let Expr::Call(_) = written else {
        let name = name_of(written, "picker", Picker::WORDS, context)?;
        return Ok((
            Picker::from_word(name).unwrap_or_default(),
            Manner::default(),
        ));
    };
    let (picker, ..) = made("picker", written, PICKERS, context)?;
    Ok(picker)
}

/// Reports a field that the picker states for every action, and that the model is asked for too.
pub(crate) fn stated_once(
    manner: &Manner,
    fields: &[ActionField],
    merged: &Merged<'_>,
    context: &mut Context<'_>,
) -> Result<()> {
    let Some(picker) = merged.statement("picker") else {
        return Ok(());
    };
    for (name, _) in manner.stated() {
        let parts = merged.actions().into_iter().flat_map(|part| part.fields());
        let offered = fields.iter().any(|field| field.name == name);
        let declared = parts.map(|field| field.name()).find(|it| it.text() == name);
        if let Some(declared) = declared.filter(|_| offered) {
            let message = format!("`{name}` is offered to the model, and the picker states it");
            let diagnostic = Diagnostic::new(Code::DuplicateName, declared.span(), message)
                .also(picker.value().span(), "stated here for every action")
                .help(format!(
                    "remove the field, or write the picker without `{name}`"
                ));
            return Err(context.error(diagnostic));
        }
    }
    Ok(())
}
