//! `verifier.rs` and `verifier.py`: the checks of a program as code in two languages.
//!
//! [`crate::verify`] and [`fab_program::eval`] define their meaning. The code does the same additions,
//! multiplications and comparisons in the same order, evaluates the parts of a condition until the result is certain,
//! and finds the same keypoints missing. There is one difference: a direction of the previous action that was not
//! offered counts as missing here, because turning it into a vector would need trigonometry.

mod dialect;
mod expression;
mod fields;
mod helpers;
mod layout;
mod names;
mod outline;
mod python;
mod rust;

use crate::error::EmitError;
use fab_program::Program;
use outline::Outline;

/// Writes the Rust module.
pub(super) fn rust(program: &Program) -> Result<String, EmitError> {
    Ok(rust::module(&Outline::of(program, &rust::DIALECT)?))
}

/// Writes the Python module.
pub(super) fn python(program: &Program) -> Result<String, EmitError> {
    Ok(python::module(&Outline::of(program, &python::DIALECT)?))
}
