//! Diagnostics: what is wrong with a source, as data. Text and JSON are made from it.
//!
//! A [`Diagnostic`] has a code, a message with the values, a main location, other locations that matter, and advice.
//! Messages are for readers and may change; programs should match on the code.

mod codes;
mod diagnostic;
mod json;
mod report;
mod text;

pub use codes::{CODES, Code, CodeEntry, GROUPS, Severity};
pub use diagnostic::{Certainty, Diagnostic, Edit, Label};
pub use fab_program::invisible::{is_hidden, visible};
pub use fab_program::nearest::{among, nearest};
pub use json::to_json;
pub use report::MAX_FINDINGS;
pub(crate) use report::{Report, Reported, every};
pub use text::{Color, to_text};
