//! Reads the answers of models by the task's declarations.
//!
//! In: an answer. Out: its values and every tolerated deviation, or a message to the model about what is wrong. An
//! answer that contradicts itself is rejected, never guessed at. [`crate::verify`] decides whether the values are
//! allowed.

mod action;
mod around;
mod choice;
mod cursor;
mod expression;
mod finding;
mod mark;
mod names;
mod number;
mod pixel;
mod reading;
mod schema;
mod statement;
mod text;
mod value;
mod words;

pub use action::{read_action, read_action_in, read_fields};
pub use reading::{MAX_REPLY_BYTES, MAX_TEXT_CHARS, Malformed, Reading};
pub use schema::{schema, schema_in, static_schema};
pub use text::read_text;

use crate::data::program::Program;
use crate::space;

/// Returns the lines in which an answer must state an action, with points in pixels.
pub fn answer_format(program: &Program) -> String {
    space::format(&program.actions)
}
