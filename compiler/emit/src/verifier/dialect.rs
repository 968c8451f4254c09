//! The differences between Rust and Python in an expression.

/// How a language writes what Rust and Python write differently.
pub(super) struct Dialect {
    /// The prefix of functions and tables.
    pub private: &'static str,
    /// The suffix of a call that may find something missing.
    pub may_miss: &'static str,
    /// Brackets of a pair of numbers.
    pub pair: [&'static str; 2],
    /// What surrounds a condition that must not hold.
    pub not: [&'static str; 2],
    /// The operator between conditions that must both hold.
    pub and: &'static str,
    /// The operator between conditions of which one is enough.
    pub or: &'static str,
    /// Whether there was a previous action.
    pub has_last: &'static str,
    /// The number of the step, as a float.
    pub step: &'static str,
    /// A string.
    pub text: fn(&str) -> String,
}
