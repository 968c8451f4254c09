//! Rows of `verify`: its numbers, and the checks that every task has.

use fab_program::verify::{OFFERED, REACHABLE};
use fab_program::vocabulary::{Range, Word};

/// A number in `verify`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NumberRow {
    /// The words before it.
    pub name: &'static str,
    pub range: Range,
    /// What it is, one line.
    pub doc: &'static str,
}

impl NumberRow {
    /// A limit that the overlap of two silhouettes must exceed; nothing exceeds a limit of 1.
    pub(super) const fn overlap(name: &'static str, doc: &'static str) -> NumberRow {
        let range = Range::plain("a share", 0.0, 0.999);
        NumberRow { name, range, doc }
    }

    /// How often something may be done again.
    pub(super) const fn repeats(name: &'static str, doc: &'static str) -> NumberRow {
        let range = Range::plain("a count", 1.0, 5.0);
        NumberRow { name, range, doc }
    }
}

pub(crate) const ATTEMPTS: NumberRow = NumberRow {
    name: "attempts",
    range: Range::plain("a count", 1.0, 10.0),
    doc: "the most questions per stage and action; without it, `3`",
};

/// Questions per stage and step if `attempts` is not stated: the paper's number.
pub(crate) const DEFAULT_ATTEMPTS: f64 = 3.0;

pub(crate) const OVERLAP: NumberRow = NumberRow::overlap(
    "result overlap >",
    "how much the silhouettes of the result and of the next subgoal must overlap, as a fraction",
);

pub(crate) const RETRIES: NumberRow = NumberRow::repeats(
    "retries",
    "how often a step whose result is rejected may be repeated; without it, `1`",
);

/// Further actions of a step if `retries` is not stated.
pub(crate) const DEFAULT_RETRIES: f64 = 1.0;

/// The numbers, in the order of the reference.
pub(crate) const NUMBERS: [&NumberRow; 3] = [&ATTEMPTS, &OVERLAP, &RETRIES];

/// The checks that every task has, each with what it refuses. No other check may have these names, and no task may
/// remove them.
pub(crate) const GIVEN_CHECKS: &[Word] = &[
    Word::new(OFFERED, "a value that was not offered"),
    Word::new(REACHABLE, "a point that is out of reach"),
];

/// Returns the row of a check that every task has.
pub(crate) fn given(name: &str) -> Option<&'static Word> {
    GIVEN_CHECKS.iter().find(|row| row.name == name)
}
