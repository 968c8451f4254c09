//! Limits on the length and the nesting of a text.
//!
//! They are checked before parsing, by a scan that understands strings and comments, so no input can exhaust the
//! stack of the parser or of code that walks its tree.

use crate::fault::{Fault, Problem};
use crate::source::{FileId, Span};

/// The longest text that is parsed, bytes.
pub const MAX_BYTES: usize = 1 << 20;

/// The longest word outside of texts and comments, bytes. Messages and programs repeat names.
pub const MAX_WORD_BYTES: usize = 200;

/// The most brackets and braces that may be open at once.
pub const MAX_NESTING: usize = 32;

/// Limits every later parse of this process to this many calls of grammar rules; `None` removes the limit.
///
/// Unlike a time limit, this does not depend on the machine. A parse beyond the limit reports [`Problem::TooDeep`]
/// for the whole text.
pub fn limit_calls(calls: Option<std::num::NonZeroUsize>) {
    pest::set_call_limit(calls);
}

/// Returns the first place that exceeds a limit.
pub(crate) fn exceeded(file: FileId, text: &str) -> Option<Fault> {
    if text.len() <= MAX_BYTES {
        return beyond(file, text);
    }
    let problem = Problem::TooLong {
        bytes: text.len(),
        limit: MAX_BYTES,
    };
    let span = Span::new(file, 0..0);
    Some(Fault { span, problem })
}

pub(crate) fn too_deep(span: Span) -> Fault {
    Fault {
        span,
        problem: Problem::TooDeep { limit: MAX_NESTING },
    }
}

/// Returns the first bracket, or the first word, beyond its limit.
fn beyond(file: FileId, text: &str) -> Option<Fault> {
    let bytes = text.as_bytes();
    let mut depth = 0usize;
    let mut at = 0;
    while at < bytes.len() {
        match bytes[at] {
            b'#' => at += text[at..].find(['\n', '\r']).unwrap_or(text.len() - at),
            b'"' => at = end_of_text(text, at),
            b'(' | b'{' => {
                depth += 1;
                if depth > MAX_NESTING {
                    return Some(too_deep(Span::new(file, at..at + 1)));
                }
                at += 1;
            }
            b')' | b'}' => {
                depth = depth.saturating_sub(1);
                at += 1;
            }
            // A long number is not a name, so no message repeats it.
            byte if is_word(byte) && !byte.is_ascii_digit() => {
                let length = bytes[at..]
                    .iter()
                    .take_while(|byte| is_word(**byte))
                    .count();
                if length > MAX_WORD_BYTES {
                    let problem = Problem::LongWord {
                        limit: MAX_WORD_BYTES,
                    };
                    return Some(Fault {
                        span: Span::new(file, at..at + length),
                        problem,
                    });
                }
                at += length;
            }
            _ => at += 1,
        }
    }
    None
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// Returns the end of the text that opens at `start`; an unclosed one ends with its line, a long one with its quotes.
fn end_of_text(text: &str, start: usize) -> usize {
    const TRIPLE: &str = "\"\"\"";
    if text[start..].starts_with(TRIPLE) {
        let body = start + TRIPLE.len();
        return text[body..]
            .find(TRIPLE)
            .map_or(body, |length| body + length + TRIPLE.len());
    }
    let bytes = text.as_bytes();
    let mut at = start + 1;
    while at < bytes.len() && !matches!(bytes[at], b'\n' | b'\r') {
        match bytes[at] {
            b'"' => return at + 1,
            b'\\' if matches!(bytes.get(at + 1), Some(b'"' | b'\\')) => at += 2,
            _ => at += 1,
        }
    }
    at
}
