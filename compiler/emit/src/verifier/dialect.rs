//! What Rust and Python write differently in an expression.

/// How a language writes what the two write differently.
pub(super) struct Dialect {
    /// Stands before the names of functions and tables.
    pub private: &'static str,
    /// Stands behind a call that can find something missing.
    pub may_miss: &'static str,
    /// Brackets of a pair of numbers.
    pub pair: [&'static str; 2],
    /// What stands around a condition that must not hold.
    pub not: [&'static str; 2],
    /// Between conditions that must both hold.
    pub and: &'static str,
    /// Between conditions of which one is enough.
    pub or: &'static str,
    /// Whether there was an action before this one.
    pub has_last: &'static str,
    /// The number of the step, as a float.
    pub step: &'static str,
    /// A string.
    pub text: fn(&str) -> String,
}
