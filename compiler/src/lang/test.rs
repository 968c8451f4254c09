//! Rows of `test`: the values that it gives besides keypoints and texts, and its expectations.

use fab_program::vocabulary::{Range, Word};

/// The values that a test may give besides the task's keypoints and texts.
pub(crate) const GIVEN: &[Word] = &[
    Word::new(
        "last.pick",
        "where the previous action gripped the cloth, a pixel",
    ),
    Word::new(
        "last.place",
        "where the previous action released it, a pixel",
    ),
    Word::new("step", "which step it is; without it, the first"),
];

/// The number of a step.
pub(crate) const STEP: Range = Range::plain("a step", 1.0, 100.0);

/// The outcomes that a test may expect.
pub(crate) const EXPECTATIONS: &[Word] = &[
    Word::new("accept", "every check accepts the action"),
    Word::new(
        "reject",
        "the check in brackets rejects the action: `reject(far)`",
    ),
    Word::new("malformed", "the answer cannot be read"),
    Word::new("text", "the stage reads this text: `text \"fold left\"`"),
];
