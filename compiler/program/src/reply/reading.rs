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
    pub(super) fn new(
        field: &str,
        reply: &str,
        span: Range<usize>,
        repairs: Vec<String>,
    ) -> Stated {
        let span = with_marks(reply, span);
        Stated {
            field: field.to_owned(),
            text: reply.get(span.clone()).unwrap_or_default().to_owned(),
            at: span.start,
            repairs,
        }
    }
}

/// Adds the other half of the marks that a piece of an answer has: `**Pick**`, `\text{…}`, `\(…\)`, quotes, and a tag.
pub(super) fn with_marks(reply: &str, span: Range<usize>) -> Range<usize> {
    let is_mark = |letter: char| matches!(letter, '*' | '_' | '`' | '$');
    let (Some(before), Some(text), Some(after)) = (
        reply.get(..span.start),
        reply.get(span.clone()),
        reply.get(span.end..),
    ) else {
        return span;
    };
    let count = |brace: char| text.matches(brace).count();
    let unopened = count('}').saturating_sub(count('{'));
    let start = (0..unopened).fold(before.len(), |start, _| {
        opened(&before[..start]).unwrap_or(start)
    });
    let start = before[..start].trim_end_matches(is_mark).len();
    let open = count('{').saturating_sub(count('}'));
    let closes = after.chars().take_while(|letter| *letter == '}').take(open);
    let end = span.end + closes.count();
    let is_quoted = text.matches('"').count() % 2 == 1 && reply[end..].starts_with('"');
    let end = end + usize::from(is_quoted);
    let is_formula = text.contains("\\(") && !text.contains("\\)");
    let closed = reply[end..]
        .strip_prefix("\\)")
        .or(reply[end..].strip_prefix(")\\)"));
    let end = closed
        .filter(|_| is_formula)
        .map_or(end, |rest| reply.len() - rest.len());
    let marks = reply[end..].chars().take_while(|letter| is_mark(*letter));
    let end = end + marks.map(char::len_utf8).sum::<usize>();
    match before[..start].strip_suffix('<') {
        Some(before) => before.len()..end + tag_end(&reply[end..]),
        None => start..end,
    }
}

/// Returns how long the rest of a tag is at the start of a text: `</pick>`, `/>`.
fn tag_end(rest: &str) -> usize {
    /// The longest rest of a tag, bytes.
    const MOST: usize = 80;
    let inside = { rest.bytes().take(MOST) }.take_while(|it| !matches!(it, b'>' | b'\n'));
    let length = inside.count();
    match rest.as_bytes().get(length) {
        Some(b'>') if rest.trim_start().starts_with(['<', '/']) => length + 1,
        _ => 0,
    }
}

/// Returns where an open brace at the end of a text begins, with its command: `\text{`.
fn opened(before: &str) -> Option<usize> {
    let command = before.strip_suffix('{')?;
    let name = command.trim_end_matches(|letter: char| letter.is_ascii_alphabetic());
    Some(name.strip_suffix('\\').map_or(command.len(), str::len))
}

/// Why an answer cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Malformed {
    /// What was missing or unclear: a field of the action, or the words before a text.
    pub field: String,
    /// The message to the model: what is missing or ambiguous, and the requested format.
    pub message: String,
    /// Where the answer states the fields that could be read.
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
