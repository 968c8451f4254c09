//! The pictures that show what to do, step by step.

use crate::data::camera::PixelPoint;
use crate::data::files::FileRef;
use crate::data::folds::Fold;
use serde::{Deserialize, Serialize};

/// Where the subgoal pictures come from. `n` folds have `n + 1` pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "from", rename_all = "snake_case")]
pub enum Subgoals {
    /// Drawn by the simulator, which executes these folds on the task's flat cloth.
    Demonstrate {
        /// One fold per step.
        folds: Vec<Fold>,
    },
    /// The author's own pictures.
    Images {
        /// At least two, in order.
        images: Vec<SubgoalImage>,
    },
}

impl Subgoals {
    /// Returns the number of steps that the pictures show.
    pub fn steps(&self) -> usize {
        match self {
            Subgoals::Demonstrate { folds } => folds.len(),
            Subgoals::Images { images } => images.len().saturating_sub(1),
        }
    }
}

/// One of the author's pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SubgoalImage {
    /// The picture.
    pub file: FileRef,
    /// Tail and tip of the arrow to draw on it, in the picture's pixels; `None` if the picture already has one.
    pub arrow: Option<[PixelPoint; 2]>,
}
