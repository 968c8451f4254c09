//! Annotations: what is drawn on the camera's picture before a model sees it.

use super::points::Point;
use super::uses::{Depends, Uses};
use serde::{Deserialize, Serialize};

/// One layer of drawing; later layers cover earlier ones.
///
/// A layer that needs the previous action is not drawn in the first step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Its name in the task.
    pub name: String,
    /// The colour, red green blue.
    pub rgb: [u8; 3],
    /// What is drawn.
    pub mark: Mark,
    /// Its name in prompts, such as `blue dots`.
    pub words: String,
}

impl Layer {
    /// Returns whether it shows where the previous action was executed.
    pub fn uses_last(&self) -> bool {
        self.mark.uses().last
    }

    /// Returns whether it shows where the previous action picked.
    pub fn uses_last_pick(&self) -> bool {
        self.mark.uses().last_pick
    }
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "mark", rename_all = "snake_case")]
pub enum Mark {
    /// Filled circles.
    Dot {
        /// Where.
        at: Vec<Spot>,
        /// Pixels.
        radius_px: u32,
    },
    /// Circles.
    Ring {
        /// Where.
        at: Vec<Spot>,
        /// Pixels.
        radius_px: u32,
        /// Width of the line, pixels.
        width_px: u32,
    },
    /// Upright crosses.
    Cross {
        /// Where.
        at: Vec<Spot>,
        /// Length of each arm, pixels.
        radius_px: u32,
        /// Width of the lines, pixels.
        width_px: u32,
    },
    /// The number of each point in its list, from 1, written next to it.
    Number {
        /// Where.
        at: Vec<Spot>,
    },
    /// An arrow.
    Arrow {
        /// Its tail.
        from: Point,
        /// Its tip.
        to: Point,
        /// Width of the line, pixels.
        width_px: u32,
    },
    /// The sides of a box: every `spacing_px`-th pixel of them.
    Box {
        /// The keypoint.
        of: String,
        /// Distance between drawn pixels; 1 is a solid line.
        spacing_px: u32,
    },
    /// An outline's sides.
    Outline {
        /// The keypoint.
        of: String,
        /// Width of the line, pixels.
        width_px: u32,
    },
}

/// Where something is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "spot", rename_all = "snake_case")]
pub enum Spot {
    /// At each point of a keypoint.
    Points {
        /// The keypoint.
        keypoint: String,
    },
    /// At one point.
    One {
        /// The point.
        point: Point,
    },
}

impl Depends for Mark {
    fn add_uses(&self, uses: &mut Uses) {
        match self {
            Mark::Dot { at, .. }
            | Mark::Ring { at, .. }
            | Mark::Cross { at, .. }
            | Mark::Number { at } => at.add_uses(uses),
            Mark::Arrow { from, to, .. } => {
                from.add_uses(uses);
                to.add_uses(uses);
            }
            Mark::Box { of, .. } | Mark::Outline { of, .. } => {
                uses.keypoints.insert(of.clone());
            }
        }
    }
}

impl Depends for Spot {
    fn add_uses(&self, uses: &mut Uses) {
        match self {
            Spot::Points { keypoint } => {
                uses.keypoints.insert(keypoint.clone());
            }
            Spot::One { point } => point.add_uses(uses),
        }
    }
}
