//! The result of reading an answer: a value with its repairs, or a message to the model.

use super::aside::Aside;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The longest answer that is read, bytes.
pub const MAX_REPLY_BYTES: usize = 1 << 20;

/// The longest text that is taken from an answer, characters.
pub const MAX_TEXT_CHARS: usize = 2_000;

/// A value that was read, and the tolerated deviations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reading<T> {
    /// The value.
    pub value: T,
    /// Each deviation from the requested format, in words; empty if there is none.
    pub repairs: Vec<String>,
    /// Where the answer states it: each field of an action, or the text.
    pub stated: Vec<Stated>,
    /// The parts of the answer that state nothing, as bytes, and why not.
    pub asides: Vec<(Range<usize>, Aside)>,
}

/// Where an answer states a value.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stated {
    /// A field of the action, or the words before a text.
    pub field: String,
    /// The characters that state it.
    pub text: String,
    /// Where they begin in the answer, bytes.
    pub at: usize,
    /// The deviations in it.
    pub repairs: Vec<String>,
}

impl Stated {
    pub(super) fn new(field: &str, reply: &str, span: Range<usize>, repairs: &[String]) -> Stated {
        let span = with_marks(reply, span);
        Stated {
            field: field.to_owned(),
            text: reply.get(span.clone()).unwrap_or_default().to_owned(),
            at: span.start,
            repairs: repairs.to_owned(),
        }
    }
}

/// Adds the marks around a piece of an answer: `**Pick Point**`, `\boxed{…}`.
pub(super) fn with_marks(reply: &str, span: Range<usize>) -> Range<usize> {
    let is_mark = |letter: char| "*_`$\"".contains(letter);
    let start = reply[..span.start].trim_end_matches(is_mark).len();
    let (text, mut behind) = (&reply[span.clone()], &reply[span.end..]);
    if text.matches('{').count() > text.matches('}').count() {
        behind = behind.strip_prefix('}').unwrap_or(behind);
    }
    behind = behind.trim_start_matches(is_mark);
    start..reply.len() - behind.len()
}

/// Why an answer cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Malformed {
    /// What was missing or unclear: a field of the action, or the words before a text.
    pub field: String,
    /// The message to the model: what is missing or ambiguous, and the requested format.
    pub message: String,
    /// Where the answer states the fields that could be read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stated: Vec<Stated>,
}

/// Rejects an answer that is too long.
pub(super) fn bounded(field: &str, reply: &str) -> Result<(), Malformed> {
    if reply.len() <= MAX_REPLY_BYTES {
        return Ok(());
    }
    let message = format!(
        "Your answer has {} characters. Answer again in less than {MAX_REPLY_BYTES}, in the format asked for.",
        reply.chars().count()
    );
    Err(Malformed {
        field: field.to_owned(),
        message,
        stated: Vec::new(),
    })
}

/// Shortens a quotation from an answer.
pub(super) fn quoted(text: &str) -> String {
    const MOST: usize = 60;
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if line.chars().count() <= MOST {
        line
    } else {
        line.chars().take(MOST).chain(['…']).collect()
    }
}
