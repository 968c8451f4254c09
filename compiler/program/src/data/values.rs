//! The conditions of checks and of texts.
//!
//! Evaluation always ends and fails only on a missing keypoint; [`crate::eval`] defines it.

use super::points::{Heading, Point};
use super::uses::{Depends, Uses};
use crate::measures::{Length, Number};
use serde::{Deserialize, Serialize};

/// A condition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum Condition {
    /// Every part holds.
    All {
        /// The parts.
        of: Vec<Condition>,
    },
    /// At least one part holds.
    Any {
        /// The parts.
        of: Vec<Condition>,
    },
    /// The part does not hold.
    Not {
        /// The part.
        of: Box<Condition>,
    },
    /// Two lengths compare like this. Their squares are compared, which needs no root.
    Lengths {
        /// Left of the sign.
        left: Length,
        /// The sign.
        is: Comparison,
        /// Right of the sign.
        right: Length,
    },
    /// The angle between two directions, 0 to 180 degrees, compares like this with a limit.
    ///
    /// With `d = a · b` this compares `d |d|` with `c |c| |a|² |b|²`, which needs no root and no trigonometry. If a
    /// direction has no length (its ends are one point), both are 0.
    Angle {
        /// One direction.
        a: Heading,
        /// The other.
        b: Heading,
        /// How the angle compares with the limit.
        is: Comparison,
        /// The limit, degrees, 0 to 180.
        limit_deg: f64,
        /// Its cosine `c`.
        limit_cos: f64,
    },
    /// A number compares like this with a limit.
    Number {
        /// The number.
        left: Number,
        /// The sign.
        is: Comparison,
        /// The limit.
        limit: f64,
    },
    /// A field that is a word has this value.
    Word {
        /// The field.
        field: String,
        /// The word.
        is: String,
    },
    /// A point is in a mask or a box, or at most `margin_px` away from it.
    Within {
        /// The point, rounded to a whole pixel.
        point: Point,
        /// The mask or box.
        region: String,
        /// Distance to the nearest pixel of the region that is still accepted, pixels.
        margin_px: f64,
    },
    /// There was a previous action.
    Last,
    /// Some candidate points are unreachable. Never used in a check, because hosts of emitted verifiers do not know
    /// which.
    Unreachable,
}

impl Depends for Condition {
    fn add_uses(&self, uses: &mut Uses) {
        match self {
            Condition::All { of } | Condition::Any { of } => of.add_uses(uses),
            Condition::Not { of } => of.add_uses(uses),
            Condition::Lengths { left, right, .. } => {
                left.add_uses(uses);
                right.add_uses(uses);
            }
            Condition::Angle { a, b, .. } => {
                a.add_uses(uses);
                b.add_uses(uses);
            }
            Condition::Number { left, .. } => left.add_uses(uses),
            Condition::Word { field, .. } => uses.add_field(field),
            Condition::Within { point, region, .. } => {
                point.add_uses(uses);
                uses.keypoints.insert(region.clone());
            }
            // Whether there was a previous action is known in the first step too.
            Condition::Last => uses.history = true,
            Condition::Unreachable => uses.reach = true,
        }
    }
}

impl Condition {
    /// Returns whether it can hold only if there was a previous action.
    pub fn implies_last(&self) -> bool {
        match self {
            Condition::Last => true,
            Condition::All { of } => of.iter().any(Condition::implies_last),
            Condition::Any { of } => !of.is_empty() && of.iter().all(Condition::implies_last),
            _ => false,
        }
    }
}

/// How two numbers compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    AtMost,
    /// `>`
    Greater,
    /// `>=`
    AtLeast,
}

impl Comparison {
    /// Returns whether `left` compares like this with `right`; always false if one is NaN.
    pub fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Comparison::Less => left < right,
            Comparison::AtMost => left <= right,
            Comparison::Greater => left > right,
            Comparison::AtLeast => left >= right,
        }
    }

    /// Returns the comparison that holds for negated numbers, or with the sides swapped.
    pub fn reversed(self) -> Comparison {
        match self {
            Comparison::Less => Comparison::Greater,
            Comparison::AtMost => Comparison::AtLeast,
            Comparison::Greater => Comparison::Less,
            Comparison::AtLeast => Comparison::AtMost,
        }
    }

    /// Returns its sign.
    pub fn sign(self) -> &'static str {
        match self {
            Comparison::Less => "<",
            Comparison::AtMost => "<=",
            Comparison::Greater => ">",
            Comparison::AtLeast => ">=",
        }
    }
}
