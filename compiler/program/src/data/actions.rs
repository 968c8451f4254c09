//! The discretised action space: one declaration for prompt, schema, parser, verifier and sampler.

use crate::data::camera::PixelPoint;
use crate::units::LengthUnit;
use serde::{Deserialize, Serialize};

/// One field of an answer and its choices.
///
/// Every action has `pick`, which is points, and either `place`, which is points too, or `direction` and `distance`.
/// Those of a [`Manner`](super::manner::Manner) say how the cloth is carried. Further fields are read, checked and
/// recorded, and move nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActionField {
    /// Its name.
    pub name: String,
    /// What it may be.
    pub choices: Choices,
}

impl ActionField {
    /// Returns whether its values are pixels.
    pub fn is_point(&self) -> bool {
        self.choices.are_points()
    }

    /// Returns what an offered length or speed is, metres or metres per second; `None` for any other value.
    pub fn metres(&self, value: &Value) -> Option<f64> {
        let (Choices::Lengths { choices, .. }, Value::Length { length }) = (&self.choices, value)
        else {
            return None;
        };
        let choice = choices.iter().find(|choice| choice.value == *length);
        choice.map(|choice| choice.m)
    }
}

impl Choices {
    /// Returns whether the choices are pixels: those of keypoints, or of a region.
    pub fn are_points(&self) -> bool {
        matches!(self, Choices::Points { .. } | Choices::Region { .. })
    }
}

/// The choices of a field, in the order of the prompt.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "of", rename_all = "snake_case")]
pub enum Choices {
    /// The points of these keypoints.
    Points {
        /// Keypoints with one point or several.
        keypoints: Vec<String>,
    },
    /// Any pixel of a mask.
    Region {
        /// The mask.
        mask: String,
    },
    /// Directions in the picture.
    Directions {
        /// All different.
        choices: Vec<Direction>,
    },
    /// Lengths on the table, or speeds, which are lengths per second; the unit says which.
    Lengths {
        /// The unit that prompt and answer use.
        unit: LengthUnit,
        /// All different.
        choices: Vec<LengthChoice>,
    },
    /// Words.
    Words {
        /// All different, ignoring case.
        choices: Vec<String>,
    },
}

/// A direction in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Direction {
    /// Degrees, counter-clockwise from the image's right, `0 <= deg < 360`.
    pub deg: f64,
    /// The same as a unit vector, right and down: 90 degrees is `[0, -1]`.
    pub vector: [f64; 2],
}

/// A length on the table, or a speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LengthChoice {
    /// In the field's unit, as declared.
    pub value: f64,
    /// In metres, or in metres per second.
    pub m: f64,
}

/// The value of one field of an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// A pixel, `[u, v]`.
    Point(crate::data::camera::PixelPoint),
    /// A direction, `{"deg": 45}`: `0 <= deg < 360`.
    Direction {
        /// Degrees, counter-clockwise from the image's right.
        deg: f64,
    },
    /// A length or a speed, `{"length": 0.25}`, in the field's unit.
    Length {
        /// The number.
        length: f64,
    },
    /// A word.
    Word(String),
}

/// An action as the model stated it, before any check.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Proposal {
    /// Each field's value, in the order of the declaration.
    pub fields: Vec<(String, Value)>,
}

impl Proposal {
    /// Returns a field's value.
    pub fn get(&self, field: &str) -> Option<&Value> {
        self.fields
            .iter()
            .find(|(name, _)| name == field)
            .map(|(_, value)| value)
    }

    /// Returns a field's point; `None` if the field is not a point.
    pub fn point(&self, field: &str) -> Option<PixelPoint> {
        match self.get(field)? {
            Value::Point(point) => Some(*point),
            _ => None,
        }
    }
}
