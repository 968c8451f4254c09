//! The result of looking for a field's value at one place of an answer, and how clearly it is stated there.

use crate::data::actions::Value;

/// How clearly something is a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Clarity {
    /// `pick (10, 20)`.
    Loose,
    /// `the pick point is (10, 20)`, `pick point (10, 20)`.
    Spoken,
    /// `Pick Point = (10, 20)`, `"pick": [10, 20]`.
    Assigned,
}

/// What was found where a value is expected.
pub(super) enum Found {
    /// A value, and how it was read if that is not obvious.
    Value(Value, Option<String>),
    /// Something that is not a value, and why not.
    Bad(String),
    /// Something else.
    Nothing,
}
