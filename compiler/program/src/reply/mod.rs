//! Reads the answers of models, as the task's declarations say.
//!
//! In: an answer. Out: what it says, with every tolerated deviation named, or what is wrong with it in
//! words for the model. An answer that states one thing in two ways is never guessed at. Whether the
//! values are allowed is judged by [`crate::verify`].

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

/// Returns the lines in which an answer states an action, points in pixels.
pub fn answer_format(program: &Program) -> String {
    space::format(&program.actions)
}
