//! What is wrong with a source, as data; text and JSON are made from it.
//!
//! A [`Diagnostic`] has a code, a main place, the values, other places where they matter, and what
//! would be right. The wording is here to be read by people; programs go by the code.

mod codes;
mod diagnostic;
mod json;
mod report;
mod suggest;
mod text;

pub use codes::{CODES, Code, CodeEntry, GROUPS, Severity};
pub use diagnostic::{Certainty, Diagnostic, Edit, Label};
pub use json::to_json;
pub use report::MAX_FINDINGS;
pub(crate) use report::{Report, Reported};
pub use text::{Color, to_text};

pub use suggest::{among, nearest};
