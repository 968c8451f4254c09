//! Reads the answers of models by the task's declarations.
//!
//! In: an answer. Out: its values and every tolerated deviation, or a message to the model about what is wrong. An
//! answer that contradicts itself is rejected, never guessed at. [`crate::verify`] decides whether the values are
//! allowed.

mod action;
mod around;
mod aside;
mod candidates;
mod choice;
mod chosen;
mod claim;
mod claims;
mod corners;
mod cursor;
mod data;
mod doubt;
mod lexer;
mod names;
mod object;
mod point;
mod quantity;
mod reading;
mod remarks;
mod schema;
mod sentences;
mod sizes;
mod text;
mod value;
mod ways;
mod wordlist;
mod words;

pub use action::{read_action, read_action_in, read_fields};
pub use aside::Aside;
pub use claims::{Standing, standing};
pub use reading::{MAX_REPLY_BYTES, MAX_TEXT_CHARS, Malformed, Reading, Stated};
pub use schema::{schema, schema_in, static_schema};
pub use text::read_text;
