//! The differences between Rust and Python.

use super::names;

/// How a language writes what Rust and Python write differently.
pub(crate) struct Dialect {
    /// The template of the module.
    pub template: &'static str,
    /// The functions that it calls.
    pub support: &'static str,
    /// The suffix of a call that may find something missing.
    pub may_miss: &'static str,
    /// Brackets of a pair of numbers.
    pub pair: [&'static str; 2],
    /// What stands before a condition in brackets that must not hold.
    pub not: &'static str,
    /// The operator between conditions that must both hold.
    pub and: &'static str,
    /// The operator between conditions of which one is enough.
    pub or: &'static str,
    /// Whether there was a previous action.
    pub has_last: &'static str,
    /// The type of a pixel.
    pub pixel_type: &'static str,
    /// The type of a number.
    pub number_type: &'static str,
    /// The type of a word.
    pub word_type: &'static str,
    /// Escapes text for a string or a comment, in ASCII.
    pub escaped: fn(&str) -> String,
}

/// The Rust module; it needs only `core` and does not allocate.
pub(crate) const RUST: Dialect = Dialect {
    template: include_str!("verifier.rs.j2"),
    support: include_str!("support.rs"),
    may_miss: "?",
    pair: ["[", "]"],
    not: "!",
    and: "&&",
    or: "||",
    has_last: "facts.last.is_some()",
    pixel_type: "[i32; 2]",
    number_type: "f64",
    word_type: "&'a str",
    escaped: names::rust_escaped,
};

/// The Python module; it needs only the standard library.
pub(crate) const PYTHON: Dialect = Dialect {
    template: include_str!("verifier.py.j2"),
    support: include_str!("support.py"),
    may_miss: "",
    pair: ["(", ")"],
    not: "not ",
    and: "and",
    or: "or",
    has_last: "facts.last is not None",
    pixel_type: "Tuple[int, int]",
    number_type: "float",
    word_type: "str",
    escaped: names::python_escaped,
};

impl Dialect {
    /// Writes a string.
    pub fn text(&self, text: &str) -> String {
        format!("\"{}\"", (self.escaped)(text))
    }

    /// Writes a pair of numbers.
    pub fn pair(&self, one: &str, other: &str) -> String {
        let [open, close] = self.pair;
        format!("{open}{one}, {other}{close}")
    }
}
