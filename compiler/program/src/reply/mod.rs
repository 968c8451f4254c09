//! Reads the answers of models by the task's declarations, and by their form alone.
//!
//! In: an answer. Out: its values and every tolerated deviation, or a message to the model about what is wrong. An
//! answer to a schema is read exactly; another one by its objects and labelled statements. One that states two values
//! is rejected, never guessed at, and prose is not read. [`crate::verify`] decides whether the values are allowed.

mod action;
mod aside;
mod claim;
mod cursor;
mod data;
mod lexer;
mod names;
mod object;
mod phrases;
mod point;
mod quantity;
mod reading;
mod schema;
mod statements;
mod structured;
mod text;
mod value;

pub use action::{read_action, read_action_in, read_fields};
pub use aside::{Aside, Standing, standing};
pub use reading::{MAX_REPLY_BYTES, MAX_TEXT_CHARS, Malformed, Reading, Stated};
pub use schema::{for_stage, schema_in, static_schema, text_schema};
pub use text::read_text;
pub use value::SAME_DEG;
