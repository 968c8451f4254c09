//! `picker drop`: how the gripper carries and releases the cloth.

use super::context::Context;
use super::expressions::name_of;
use crate::diag::Reported;
use fab_grammar::ast::Statement;
use fab_program::Picker;

/// Reads how the gripper carries and releases the cloth.
pub(crate) fn check(
    statement: Statement<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Picker, Reported> {
    let name = name_of(statement.value(), "picker", Picker::WORDS, context)?;
    Ok(Picker::from_word(name).unwrap_or_default())
}
