//! What an answer states about one field, before it is decided which value is meant.

use super::words;
use crate::data::actions::Value;
use std::ops::Range;

/// How far a direction in words may be from the angle that it describes, degrees.
const WORDED_DEG: f64 = 67.5;

/// How far an angle may be from the choice to which it is rounded, degrees.
const ROUNDED_DEG: f64 = 22.5;

/// A statement about a field.
#[derive(Debug)]
pub(super) struct Claim {
    /// The field, by its index.
    pub field: usize,
    /// Where it stands in the answer, bytes.
    pub span: Range<usize>,
    pub claimed: Claimed,
}

impl Claim {
    pub fn new(field: usize, span: Range<usize>, claimed: Claimed) -> Claim {
        Claim {
            field,
            span,
            claimed,
        }
    }

    /// Returns the value that it states of a field, if it states one.
    pub fn value_of(&self, field: usize) -> Option<&Value> {
        match &self.claimed {
            Claimed::Value(value, _) if self.field == field => Some(value),
            _ => None,
        }
    }
}

/// What a claim says.
#[derive(Debug)]
pub(super) enum Claimed {
    /// The field has this value; how it was read, if that is not obvious.
    Value(Value, Option<String>),
    /// It may have this value, which the answer does not choose: `might as well be`.
    Hedge(Value),
    /// One coordinate of a point.
    Axis(char, f64),
    /// The answer judges that this value is unfit: `0.75 edge is too far`.
    Unfit(Value),
    /// Something is moved in this direction, degrees; the words are coarser than the choices.
    Course(f64),
    /// Its point is the corner on this side, degrees.
    Side(f64),
    /// It is one of these, by words that are coarser than the choices: `a short pull`.
    OneOf(Vec<Value>),
    /// The answer says in its own words that it chooses one of these, perhaps rounded: `2. (10, 20), the tip of the flap`. It
    /// is refused where all that is left names other values, whatever it says of the value's size or side.
    Chosen(Vec<Named>),
    /// Words that do not state one value, the reason, and how each value that they name is meant.
    Prose(String, Vec<Named>),
    /// Something that is not a value, and why not.
    Bad(String),
    /// What states no value and cannot be told apart, and the reason.
    Unclear(String),
    /// A value that its own words contradict: `pull it down (90 deg)`.
    Torn,
    Nothing,
}

impl Claimed {
    /// Returns whether it is in words that are coarser than the choices.
    pub fn is_worded(&self) -> bool {
        matches!(
            self,
            Claimed::Course(_) | Claimed::Side(_) | Claimed::OneOf(_) | Claimed::Chosen(_)
        )
    }

    /// Returns whether no single value is meant: nothing is understood, or several values are weighed.
    pub fn is_unclear(&self) -> bool {
        match self {
            Claimed::Unclear(_) => true,
            Claimed::Prose(_, named) => named
                .iter()
                .any(|it| named.first().is_some_and(|first| it.value != first.value)),
            _ => false,
        }
    }
}

/// A value that prose names.
#[derive(Debug)]
pub(super) struct Named {
    pub value: Value,
    /// Whether it is a direction in words, which are coarser than angles: `right and slightly down`.
    pub is_worded: bool,
}

impl Named {
    /// Returns whether prose that names this may speak of a value.
    pub fn may_mean(&self, value: &Value) -> bool {
        match (&self.value, value) {
            (Value::Direction { deg: named }, Value::Direction { deg }) => {
                let most = if self.is_worded {
                    WORDED_DEG
                } else {
                    ROUNDED_DEG
                };
                words::apart_deg(*named, *deg) <= most
            }
            (named, value) => named == value,
        }
    }
}
