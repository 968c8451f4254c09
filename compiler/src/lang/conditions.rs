//! Rows of conditions: words that are not calls, and the signs between two values.

use fab_program::vocabulary::Range;
use fab_program::{Comparison, Condition};

// ---- words ---------------------------------------------------------------------------------------

/// A word of conditions that is not a call.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WordRow {
    pub name: &'static str,
    /// The condition that the word is by itself; `None` for a value to compare.
    pub condition: Option<fn() -> Condition>,
    /// What it says, one line.
    pub doc: &'static str,
}

/// The word for unreachable points: a condition of components, and a value in texts.
pub(crate) const UNREACHABLE: &str = "unreachable";

/// The words.
pub(crate) const WORDS: &[WordRow] = &[
    WordRow {
        name: "last",
        condition: Some(|| Condition::Last),
        doc: "there was a previous action",
    },
    WordRow {
        name: UNREACHABLE,
        condition: Some(|| Condition::Unreachable),
        doc: "some points are unreachable; only for components, not for checks",
    },
    WordRow {
        name: "step",
        condition: None,
        doc: "the number of this step, from 1: `step > 1`",
    },
];

// ---- signs ---------------------------------------------------------------------------------------

/// A sign between two values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SignRow {
    pub name: &'static str,
    /// A wrong sign that people write for it; the right one is then suggested.
    pub misspelling: Option<&'static str>,
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

const fn row(
    name: &'static str,
    misspelling: Option<&'static str>,
    means: Sign,
    doc: &'static str,
) -> SignRow {
    SignRow {
        name,
        misspelling,
        means,
        doc,
    }
}

/// The signs.
pub(crate) const SIGNS: &[SignRow] = &[
    row(
        "<",
        None,
        Sign::Order(Comparison::Less),
        "the left value is less",
    ),
    row(
        "<=",
        Some("≤"),
        Sign::Order(Comparison::AtMost),
        "the left value is at most the right one",
    ),
    row(
        ">",
        None,
        Sign::Order(Comparison::Greater),
        "the left value is greater",
    ),
    row(
        ">=",
        Some("≥"),
        Sign::Order(Comparison::AtLeast),
        "the left value is at least the right one",
    ),
    row(
        "==",
        None,
        Sign::Same,
        "two words or whole numbers are the same",
    ),
    row(
        "!=",
        None,
        Sign::Different,
        "two words or whole numbers differ",
    ),
];

/// Returns the meaning of a sign; `None` for a misspelt one.
pub(crate) fn sign(written: &str) -> Option<Sign> {
    SIGNS
        .iter()
        .find(|row| row.name == written)
        .map(|row| row.means)
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
