//! Points and directions of the camera's picture, as checks and texts name them.
//!
//! [`crate::eval`] evaluates them; `Display` writes the names that reports use.

use super::uses::{Depends, Uses};
use crate::exact::{normalised_deg, written};
use serde::{Deserialize, Serialize};
use std::fmt;

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
    /// Where the previous action was executed.
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
    /// The end of a direction and a distance, as the camera sees the table's plane.
    Carried {
        /// The start.
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
    /// Where the cloth is picked.
    Pick,
    /// Where it is released.
    Place,
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
    /// The same field of the previous action.
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

impl Depends for Point {
    fn add_uses(&self, uses: &mut Uses) {
        match self {
            Point::Action { field } => uses.add_field(field),
            Point::Keypoint { name } => {
                uses.keypoints.insert(name.clone());
            }
            Point::Last { end } => {
                uses.last = true;
                uses.last_pick |= *end == End::Pick;
            }
            Point::Mirror { of, about } => {
                of.add_uses(uses);
                about.add_uses(uses);
            }
            Point::Carried {
                from,
                direction,
                distance,
                ..
            } => {
                from.add_uses(uses);
                uses.add_field(direction);
                uses.add_field(distance);
            }
        }
    }
}

impl Depends for Heading {
    fn add_uses(&self, uses: &mut Uses) {
        match self {
            Heading::Field { field } => uses.add_field(field),
            Heading::Last { field } => uses.add_last_field(field),
            Heading::FromTo { from, to } => {
                from.add_uses(uses);
                to.add_uses(uses);
            }
            Heading::Constant { .. } => {}
        }
    }
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Point::Action { field: name } | Point::Keypoint { name } => f.write_str(name),
            Point::Last { end: End::Pick } => f.write_str("last.pick"),
            Point::Last { end: End::Place } => f.write_str("last.place"),
            Point::Mirror { of, about } => write!(f, "mirror({of}, {about})"),
            Point::Carried { .. } => f.write_str("place"),
        }
    }
}

impl fmt::Display for Heading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Heading::Field { field } => f.write_str(field),
            Heading::Last { field } => write!(f, "last.{field}"),
            Heading::FromTo { from, to } => write!(f, "from {from} to {to}"),
            Heading::Constant { vector } => {
                let deg = libm::atan2(-vector[1], vector[0]).to_degrees();
                write!(f, "{} deg", written(normalised_deg(deg), 1))
            }
        }
    }
}
