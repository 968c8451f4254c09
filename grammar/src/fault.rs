//! Syntax faults as data; the compiler words the messages.

use crate::source::Span;

/// One syntax fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The bytes at fault.
    pub span: Span,
    /// What is wrong.
    pub problem: Problem,
}

/// The kinds of syntax faults.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Problem {
    /// The text is too long.
    TooLong {
        /// Its length.
        bytes: usize,
        /// The limit.
        limit: usize,
    },
    /// Too many brackets are open.
    TooDeep {
        /// The limit.
        limit: usize,
    },
    /// A word is too long.
    LongWord {
        /// The limit, bytes.
        limit: usize,
    },
    /// The markers of a merge that nobody has resolved.
    MergeConflict {
        /// The lines that begin with a marker, in order; the first is the fault's own.
        markers: Vec<Span>,
    },
    /// Something else belongs here.
    Unexpected {
        /// The text here; `None` at the end of the line.
        found: Option<String>,
        /// What would fit, in words for users; may be empty.
        expected: Vec<&'static str>,
        /// The words of the language that would fit, for the nearest one to be suggested.
        words: Vec<&'static str>,
    },
    /// A line begins with an unknown word.
    UnknownWord {
        /// The word.
        word: String,
        /// The words that may begin a line here.
        candidates: &'static [&'static str],
        /// The words that may go on with the line before.
        words: Vec<&'static str>,
        /// The keyword of the surrounding block; `None` for the file itself.
        block: Option<String>,
    },
    /// A `{` is missing.
    MissingOpen {
        /// The block's keyword.
        block: String,
    },
    /// The `}` of this `{` is missing.
    MissingClose {
        /// The block's keyword.
        block: String,
    },
    /// A block has no name.
    MissingName {
        /// The word that the name follows.
        after: String,
    },
    /// There is something between a block's name and its `{`.
    Surplus {
        /// Its text.
        found: String,
    },
    /// A `}` without an opening brace.
    StrayClose {
        /// A `}` before it that stands further in than the line of its `{`.
        early: Option<Span>,
    },
    /// A section is outside of any task.
    OutsideTask {
        /// Its keyword.
        word: String,
        /// A `}` before it that stands further in than the line of its `{`.
        early: Option<Span>,
    },
    /// A comma after the last part of a list.
    TrailingComma,
    /// A text between quotes does not end on its line.
    UnclosedString,
    /// A text without its opening quote.
    UnopenedString,
    /// A text between triple quotes does not end.
    UnclosedText,
    /// Quotes that are not `"`.
    WrongQuotes {
        /// The text with the right quotes.
        right: String,
    },
    /// A `\` before a character that needs no escape.
    BadEscape,
    /// `{{` without a name and `}}`.
    LoneBraces,
}
