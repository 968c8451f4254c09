//! Closed sets of words: how a task writes each value of an enumeration.

/// A word of a closed set.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Word {
    /// The word.
    pub name: &'static str,
    /// What it means, a few words.
    pub doc: &'static str,
}

impl Word {
    /// Makes a word.
    pub const fn new(name: &'static str, doc: &'static str) -> Word {
        Word { name, doc }
    }
}

/// Gives an enumeration its words: how a task writes each value, and what it means.
macro_rules! words {
    ($type:ident { $($word:literal => $variant:ident, $doc:literal;)* }) => {
        impl $type {
            /// The words of a task, in the order in which messages list them.
            pub const WORDS: &'static [$crate::words::Word] =
                &[$($crate::words::Word::new($word, $doc)),*];

            /// Returns the value that a word of a task means; `None` if it is not such a word.
            pub fn from_word(word: &str) -> Option<$type> {
                match word {
                    $($word => Some($type::$variant),)*
                    _ => None,
                }
            }

            /// Returns the word that a task writes for it.
            pub fn word(self) -> &'static str {
                match self {
                    $($type::$variant => $word,)*
                }
            }
        }
    };
}
pub(crate) use words;
