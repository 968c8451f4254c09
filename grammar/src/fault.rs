//! What can be wrong with the form of a text, as facts; the compiler puts them into words.

use crate::source::Span;

/// One place where the form is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The bytes at fault.
    pub span: Span,
    /// What is wrong.
    pub problem: Problem,
}

/// What can be wrong with the form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Problem {
    /// The text is longer than is parsed.
    TooLong {
        /// Its length.
        bytes: usize,
        /// The limit.
        limit: usize,
    },
    /// More brackets are open than is parsed.
    TooDeep {
        /// The limit.
        limit: usize,
    },
    /// A word is longer than is parsed.
    LongWord {
        /// The limit, bytes.
        limit: usize,
    },
    /// Something else belongs here.
    Unexpected {
        /// What stands here; none: the end of the line.
        found: Option<String>,
        /// What would fit, as a person would name it; may be empty.
        expected: Vec<&'static str>,
    },
    /// A line begins with a word that means nothing here.
    UnknownWord {
        /// The word.
        word: String,
        /// The words that would.
        known: &'static [&'static str],
        /// The keyword of the surrounding block; none: the file itself.
        block: Option<String>,
    },
    /// A `{` is missing.
    MissingOpen {
        /// The block's keyword.
        block: String,
    },
    /// A `}` is missing.
    MissingClose {
        /// The block's keyword.
        block: String,
        /// Where the block opens.
        opened: Span,
    },
    /// A block has no name.
    MissingName {
        /// The word that the name follows.
        after: String,
    },
    /// Something stands between a block's name and its `{`.
    Surplus {
        /// What.
        found: String,
    },
    /// A `}` that closes nothing.
    StrayClose,
    /// A section outside of any task.
    OutsideTask {
        /// Its keyword.
        word: String,
    },
    /// A comma after the last part of a list.
    TrailingComma,
    /// A text between quotes does not end on its line.
    UnclosedString,
    /// A text between triple quotes does not end.
    UnclosedText,
    /// Quotes that are not `"`.
    WrongQuotes {
        /// The text with the right ones.
        right: String,
    },
    /// A `\` before something that needs none.
    BadEscape,
    /// `{{` without a name and `}}`.
    LoneBraces,
}
