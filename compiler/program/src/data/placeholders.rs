//! The placeholders of a text: the values they show, and the format of numbers.

use super::points::{Heading, Point};
use super::uses::{Depends, Uses};
use crate::exact::written;
use crate::measures::{Length, Number};
use serde::{Deserialize, Serialize};

/// The value that a placeholder of a text shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shows", rename_all = "snake_case")]
pub enum Placeholder {
    /// A text that a stage read.
    Text {
        /// Its name.
        name: String,
    },
    /// The lines in which an answer must state the action.
    Format,
    /// How a point is written, e.g. `(x, y) in pixels`.
    PointForm,
    /// A keypoint's points, `(x, y), (x, y)`.
    Points {
        /// The keypoint.
        keypoint: String,
    },
    /// A point, `(x, y)`, rounded to whole pixels.
    Point {
        /// The point.
        point: Point,
    },
    /// A length.
    Length {
        /// In pixels or metres.
        length: Length,
        /// How it is written.
        written: NumberFormat,
    },
    /// The angle between two directions.
    Angle {
        /// One direction.
        a: Heading,
        /// The other.
        b: Heading,
        /// How it is written; the factor is applied to degrees.
        written: NumberFormat,
    },
    /// A number.
    Number {
        /// The number.
        number: Number,
        /// How it is written.
        written: NumberFormat,
    },
    /// The proposed value of a field, as the answer's format writes it.
    Field {
        /// The field.
        field: String,
    },
    /// The value of a field in the previous action.
    LastField {
        /// The field.
        field: String,
    },
    /// The unreachable candidate points, each with a reason, `(x, y): why; (x, y): why`; `none` if there are none.
    Unreachable,
    /// The choice of a direction field nearest to a direction; the first of equally near ones.
    Nearest {
        /// The field.
        field: String,
        /// The direction.
        to: Heading,
    },
    /// Where a point lies, seen from another: a word of [`QUADRANTS`](crate::measures::QUADRANTS).
    Quadrant {
        /// The point.
        point: Point,
        /// The point that it is seen from.
        about: Point,
    },
}

/// The format of a number: a factor, a number of decimals without trailing zeros, and a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NumberFormat {
    /// The factor that it is multiplied by.
    pub factor: f64,
    /// The most digits after the decimal point.
    pub decimals: u8,
    /// The text after it, such as ` px`.
    pub unit: String,
}

impl NumberFormat {
    /// Writes a number.
    pub fn write(&self, value: f64) -> String {
        let digits = written(value * self.factor, usize::from(self.decimals));
        format!("{digits}{}", self.unit)
    }
}

impl Depends for Placeholder {
    fn add_uses(&self, uses: &mut Uses) {
        match self {
            Placeholder::Text { .. } | Placeholder::Format | Placeholder::PointForm => {}
            Placeholder::Points { keypoint } => {
                uses.keypoints.insert(keypoint.clone());
            }
            Placeholder::Point { point } => point.add_uses(uses),
            Placeholder::Length { length, .. } => length.add_uses(uses),
            Placeholder::Angle { a, b, .. } => {
                a.add_uses(uses);
                b.add_uses(uses);
            }
            Placeholder::Number { number, .. } => number.add_uses(uses),
            Placeholder::Field { field } => uses.add_field(field),
            Placeholder::LastField { field } => uses.add_last_field(field),
            Placeholder::Unreachable => uses.reach = true,
            Placeholder::Nearest { to, .. } => to.add_uses(uses),
            Placeholder::Quadrant { point, about } => {
                point.add_uses(uses);
                about.add_uses(uses);
            }
        }
    }
}
