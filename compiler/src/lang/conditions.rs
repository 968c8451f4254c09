//! Rows of conditions: words that are not calls, and the signs between two values.

use fab_program::Comparison;
use fab_program::vocabulary::{Range, Word};

// ---- words ---------------------------------------------------------------------------------------

/// The word for unreachable points: a condition of components, and a value in texts.
pub(crate) const UNREACHABLE: &str = "unreachable";

/// The words of conditions that are not calls.
pub(crate) const WORDS: &[Word] = &[
    Word::new("last", "there was a previous action"),
    Word::new(
        UNREACHABLE,
        "some points are unreachable; only for components, not for checks",
    ),
    Word::new("step", "the number of this step, from 1: `step > 1`"),
];

// ---- signs ---------------------------------------------------------------------------------------

/// A sign between two values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SignRow {
    pub name: &'static str,
    pub means: Sign,
    /// What it says, one line.
    pub doc: &'static str,
}

/// The meaning of a sign between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    /// Which is the larger.
    Order(Comparison),
    /// They are equal; only for words and whole numbers.
    Same,
    /// They differ; only for words and whole numbers.
    Different,
}

const fn row(name: &'static str, means: Sign, doc: &'static str) -> SignRow {
    SignRow { name, means, doc }
}

/// The signs.
pub(crate) const SIGNS: &[SignRow] = &[
    row("<", Sign::Order(Comparison::Less), "the left value is less"),
    row(
        "<=",
        Sign::Order(Comparison::AtMost),
        "the left value is at most the right one",
    ),
    row(
        ">",
        Sign::Order(Comparison::Greater),
        "the left value is greater",
    ),
    row(
        ">=",
        Sign::Order(Comparison::AtLeast),
        "the left value is at least the right one",
    ),
    row("==", Sign::Same, "two words or whole numbers are the same"),
    row("!=", Sign::Different, "two words or whole numbers differ"),
];

/// Wrong signs that people write, each with the right one.
pub(crate) const MISSPELT_SIGNS: [(&str, &str); 2] = [("≤", "<="), ("≥", ">=")];

/// Returns the meaning of a sign; `None` for a misspelt one.
pub(crate) fn sign(written: &str) -> Option<Sign> {
    let row = SIGNS.iter().find(|row| row.name == written);
    row.map(|row| row.means)
}

// ---- ranges --------------------------------------------------------------------------------------

/// How far from a mask or a box a point may be: `within 8px of cloth`.
pub(crate) const MARGIN: Range = Range::new("a length", (0.0, "px"), (10_000.0, "px"));

/// The angle between two directions.
pub(crate) const ANGLE_BETWEEN: Range = Range::new(
    "an angle between two directions",
    (0.0, "deg"),
    (180.0, "deg"),
);
