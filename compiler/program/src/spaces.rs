//! A program's action and observation space as data for other programs, like Gymnasium's `spaces`.
//!
//! In: a program. Out: what a policy may answer and what it sees, before any picture exists. `fabc check --json` prints
//! both; which of the declared choices a step offers depends on its picture.

use crate::data::actions::{ActionField, Choices};
use crate::data::keypoints::Keypoint;
use crate::data::program::Program;
use crate::data::shape::KeypointShape;
use crate::space;
use crate::units::Dimension;
use serde::Serialize;

/// What a policy may answer, and what it sees.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spaces {
    /// What it may answer.
    pub action: ActionSpace,
    /// What it sees.
    pub observation: ObservationSpace,
}

/// What a policy may answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ActionSpace {
    /// The fields of each gripper's grip, in the order of the task.
    pub grips: Vec<Vec<FieldSpace>>,
}

/// One field of a grip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldSpace {
    /// Its name.
    pub name: String,
    /// What it may be.
    #[serde(flatten)]
    pub values: Values,
}

/// What a field may be. Choices are written as answers state them.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Values {
    /// One of the points that keypoints have in a picture, `[column, row]`.
    Point {
        /// The keypoints.
        of: Vec<String>,
        /// The most points that they give; null if the picture alone decides.
        max: Option<u32>,
        /// Where points lie.
        #[serde(flatten)]
        pixels: PixelRange,
    },
    /// Any pixel of a mask, `[column, row]`.
    Pixel {
        /// The mask.
        of: String,
        /// Where pixels lie.
        #[serde(flatten)]
        pixels: PixelRange,
    },
    /// A direction in the picture, counter-clockwise from its right.
    Direction {
        /// In words.
        choices: Vec<String>,
        /// The same in degrees.
        values: Vec<f64>,
        /// `deg`.
        unit: &'static str,
    },
    /// A length on the table, or a speed.
    Length {
        /// In words.
        choices: Vec<String>,
        /// The same in metres, or in metres per second.
        values: Vec<f64>,
        /// `m` or `m/s`.
        unit: &'static str,
    },
    /// A word.
    Word {
        /// All of them.
        choices: Vec<String>,
    },
}

/// Whole pixels of the camera's picture, `[column, row]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PixelRange {
    /// The least, inclusive.
    pub low: [u32; 2],
    /// The greatest, inclusive.
    pub high: [u32; 2],
    /// `px`.
    pub unit: &'static str,
}

/// What a policy sees in each step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ObservationSpace {
    /// The colour picture.
    pub color: ArraySpace,
    /// Distances along the optical axis; 0 means no reading.
    pub depth: ArraySpace,
    /// What is found in the picture, in the order of the task.
    pub keypoints: Vec<KeypointSpace>,
}

/// An array of numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArraySpace {
    /// Rows, columns, and channels if there are several.
    pub shape: Vec<u32>,
    /// NumPy's name of a number's type.
    pub dtype: &'static str,
    /// The least number.
    pub low: u32,
    /// The greatest number; null if there is none.
    pub high: Option<u32>,
    /// The unit; null if there is none.
    pub unit: Option<&'static str>,
}

/// Something found in the picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeypointSpace {
    /// Its name.
    pub name: String,
    /// What it is.
    pub shape: KeypointShape,
    /// The most points that it has; null if the picture alone decides, or if it has none.
    pub max: Option<u32>,
}

impl Spaces {
    /// Returns the spaces of a program; today's programs have one gripper.
    pub fn of(program: &Program) -> Spaces {
        let side = program.camera.image_px;
        let array = |shape: &[u32], dtype, high, unit| ArraySpace {
            shape: shape.to_vec(),
            dtype,
            low: 0,
            high,
            unit,
        };
        let keypoints = program.keypoints.iter().map(|keypoint| KeypointSpace {
            name: keypoint.name.clone(),
            shape: keypoint.extractor.shape(),
            max: keypoint.extractor.most_points(&program.keypoints),
        });
        let fields = program.actions.iter().map(|field| FieldSpace {
            name: field.name.clone(),
            values: Values::of(field, program),
        });
        Spaces {
            action: ActionSpace {
                grips: vec![fields.collect()],
            },
            observation: ObservationSpace {
                color: array(&[side, side, 3], "uint8", Some(255), None),
                depth: array(&[side, side], "float32", None, Some("m")),
                keypoints: keypoints.collect(),
            },
        }
    }
}

impl Values {
    fn of(field: &ActionField, program: &Program) -> Values {
        let last = program.camera.image_px.saturating_sub(1);
        let pixels = PixelRange {
            low: [0; 2],
            high: [last; 2],
            unit: "px",
        };
        let declared = space::declared(field);
        let texts = || declared.iter().map(|value| space::text(field, value));
        match &field.choices {
            Choices::Points { keypoints } => {
                let found = keypoints.iter().map(|name| program.keypoint(name));
                let most = |it: &Keypoint| it.extractor.most_points(&program.keypoints);
                Values::Point {
                    of: keypoints.clone(),
                    max: found.map(|found| found.and_then(most)).sum(),
                    pixels,
                }
            }
            Choices::Region { mask } => Values::Pixel {
                of: mask.clone(),
                pixels,
            },
            Choices::Directions { choices } => Values::Direction {
                choices: texts().collect(),
                values: choices.iter().map(|choice| choice.deg).collect(),
                unit: "deg",
            },
            Choices::Lengths { unit, choices } => Values::Length {
                choices: texts().collect(),
                values: choices.iter().map(|choice| choice.m).collect(),
                unit: match unit.dimension {
                    Dimension::Speed => "m/s",
                    _ => "m",
                },
            },
            Choices::Words { choices } => Values::Word {
                choices: choices.clone(),
            },
        }
    }
}
