//! What checks compare and texts show: points, lengths, directions, numbers, conditions.
//!
//! All of it is total: no loops, no recursion at run time, nothing that can fail but a missing keypoint.
//! What it comes to is defined by [`crate::eval`].

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// A point of the camera's picture, pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "point", rename_all = "snake_case")]
pub enum Point {
    /// A field of the proposed action.
    Action {
        /// The field.
        field: String,
    },
    /// A keypoint that is one point.
    Keypoint {
        /// The keypoint.
        name: String,
    },
    /// Where the action before this one was carried out.
    Last {
        /// Its pick or its place.
        end: End,
    },
    /// A point on the other side of another: `2 * about - of`.
    Mirror {
        /// The point that is mirrored.
        of: Box<Point>,
        /// The point between the two.
        about: Box<Point>,
    },
    /// Where a direction and a distance lead, as the camera sees the table's plane.
    Carried {
        /// Where from.
        from: Box<Point>,
        /// The field that is a direction.
        direction: String,
        /// The field that is a length.
        distance: String,
        /// Pixels in one metre on the table.
        px_per_m: f64,
    },
}

/// One end of an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// Where the cloth is taken.
    Pick,
    /// Where it is released.
    Place,
}

/// A length; both sides of a comparison are in the same unit, pixels or metres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "length", rename_all = "snake_case")]
pub enum Length {
    /// A number, at least 0.
    Constant {
        /// The number.
        value: f64,
    },
    /// The Euclidean distance between two points, pixels.
    Distance {
        /// One end.
        a: Point,
        /// The other end.
        b: Point,
    },
    /// The Chebyshev distance between two points, the larger of their distances along the two axes, pixels.
    Chebyshev {
        /// One end.
        a: Point,
        /// The other end.
        b: Point,
    },
    /// A field that is a length.
    Field {
        /// The field.
        field: String,
        /// What its metres are multiplied by: 1, or pixels per metre.
        scale: f64,
    },
}

/// A direction in the camera's picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "heading", rename_all = "snake_case")]
pub enum Heading {
    /// A field that is a direction.
    Field {
        /// The field.
        field: String,
    },
    /// The same field of the action before this one.
    Last {
        /// The field.
        field: String,
    },
    /// From one point to another.
    FromTo {
        /// Where it begins.
        from: Point,
        /// Where it leads.
        to: Point,
    },
    /// A fixed one.
    Constant {
        /// As a unit vector: right and down.
        vector: [f64; 2],
    },
}

/// A number without a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "number", rename_all = "snake_case")]
pub enum Number {
    /// How many points a keypoint has.
    Count {
        /// The keypoint.
        keypoint: String,
    },
    /// Which step of the rollout this is, from 1.
    Step,
    /// A mask's pixels over those of the flat cloth.
    Coverage {
        /// The mask.
        mask: String,
        /// The flat cloth's pixels.
        flat_px: f64,
    },
}

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
    /// Two lengths compare so. Their squares are compared, which needs no root.
    Lengths {
        /// Left of the sign.
        left: Length,
        /// The sign.
        is: Comparison,
        /// Right of the sign.
        right: Length,
    },
    /// The angle between two directions, 0 to 180 degrees, compares so with a limit.
    ///
    /// With `d = a · b` this compares `d |d|` with `c |c| |a|² |b|²`, which needs no root and no
    /// trigonometry. Where a direction has no length (its ends are one point) both are 0.
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
    /// A number compares so with a limit.
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
    /// A point lies in a mask or a box, or at most `margin_px` away from it.
    Within {
        /// The point, rounded to a whole pixel.
        point: Point,
        /// The mask or box.
        region: String,
        /// Distance to the nearest pixel of the region that is still accepted, pixels.
        margin_px: f64,
    },
    /// An action was carried out before this one.
    Last,
    /// Some candidate points are out of reach. Never in a check, which every host of an emitted verifier has to judge.
    Unreachable,
}

impl Point {
    /// Returns whether it depends on that end of the action before.
    pub fn uses_end(&self, wanted: End) -> bool {
        match self {
            Point::Last { end } => *end == wanted,
            Point::Mirror { of, about } => of.uses_end(wanted) || about.uses_end(wanted),
            Point::Carried { from, .. } => from.uses_end(wanted),
            Point::Action { .. } | Point::Keypoint { .. } => false,
        }
    }

    /// Adds the keypoints that it depends on.
    fn keypoints(&self, names: &mut BTreeSet<String>) {
        match self {
            Point::Keypoint { name } => {
                names.insert(name.clone());
            }
            Point::Mirror { of, about } => {
                of.keypoints(names);
                about.keypoints(names);
            }
            Point::Carried { from, .. } => from.keypoints(names),
            Point::Action { .. } | Point::Last { .. } => {}
        }
    }
}

impl Condition {
    /// Adds the keypoints that it depends on.
    pub fn keypoints(&self, names: &mut BTreeSet<String>) {
        match self {
            Condition::All { of } | Condition::Any { of } => {
                of.iter().for_each(|part| part.keypoints(names));
            }
            Condition::Not { of } => of.keypoints(names),
            Condition::Lengths { left, right, .. } => {
                for length in [left, right] {
                    if let Length::Distance { a, b } | Length::Chebyshev { a, b } = length {
                        a.keypoints(names);
                        b.keypoints(names);
                    }
                }
            }
            Condition::Angle { a, b, .. } => {
                for heading in [a, b] {
                    if let Heading::FromTo { from, to } = heading {
                        from.keypoints(names);
                        to.keypoints(names);
                    }
                }
            }
            Condition::Number { left, .. } => match left {
                Number::Count { keypoint: name } | Number::Coverage { mask: name, .. } => {
                    names.insert(name.clone());
                }
                Number::Step => {}
            },
            Condition::Within { point, region, .. } => {
                point.keypoints(names);
                names.insert(region.clone());
            }
            Condition::Word { .. } | Condition::Last | Condition::Unreachable => {}
        }
    }
}

impl Condition {
    /// Returns whether it may hold in a later step and not in the first one for the number of the step, or for the
    /// action before.
    pub fn looks_back(&self) -> bool {
        match self {
            Condition::All { of } | Condition::Any { of } => of.iter().any(Condition::looks_back),
            Condition::Not { of } => of.looks_back(),
            Condition::Number { left, .. } => matches!(left, Number::Step),
            // Whatever else names the action before stands beside this one.
            Condition::Last => true,
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
    /// Returns whether `left` compares so with `right`; never where one is not a number.
    pub fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Comparison::Less => left < right,
            Comparison::AtMost => left <= right,
            Comparison::Greater => left > right,
            Comparison::AtLeast => left >= right,
        }
    }

    /// Returns the comparison that holds between negated numbers, or with the sides exchanged.
    pub fn reversed(self) -> Comparison {
        match self {
            Comparison::Less => Comparison::Greater,
            Comparison::AtMost => Comparison::AtLeast,
            Comparison::Greater => Comparison::Less,
            Comparison::AtLeast => Comparison::AtMost,
        }
    }

    /// Returns how it is written.
    pub fn sign(self) -> &'static str {
        match self {
            Comparison::Less => "<",
            Comparison::AtMost => "<=",
            Comparison::Greater => ">",
            Comparison::AtLeast => ">=",
        }
    }
}
