//! Candidates that are folded on a twin of the cloth before the world moves.
//!
//! A twin is a simulated cloth that is laid as the camera's picture shows the real one. What the picture does not show,
//! its material and friction, and how far its size can be trusted, is drawn from ranges that the task states.

use crate::data::cloth::{Cloth, RECORDED_SPACING_M};
use crate::data::material::Material;
use crate::words::words;
use serde::{Deserialize, Serialize};

/// How the answers of one stage are rehearsed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rehearsal {
    /// The stage, which reads the action.
    pub stage: String,
    /// What the twins are made of.
    pub twin: TwinRanges,
    /// By which measure the best of the stage's candidates is chosen, if it has any.
    pub choose: Option<RehearsalMeasure>,
    /// How often the model may revise its answer after it has seen what would come of it.
    pub revisions: u32,
    /// The silhouettes of the twins and of the camera's cloth must overlap by more than this, the area of their
    /// intersection over that of their union, from 0 to 1.
    pub trust_above: f64,
    /// What happens where they do not.
    pub distrusted: Distrusted,
}

/// The twins of a cloth: each is drawn anew from these ranges.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TwinRanges {
    /// What they are made of; `None` is the recorded cloth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
    /// Their sides, as a factor of those that the camera sees.
    pub size: [f64; 2],
    /// Their coefficient of friction on the table.
    pub friction: [f64; 2],
    /// How many are drawn; the measures of all count, as their mean.
    pub draws: u32,
}

impl TwinRanges {
    /// Returns the distance between the particles of twins of a task's cloth, metres: that of the cloth, so that both bend
    /// alike. Twins of the recorded cloth have its own.
    pub fn spacing_m(&self, cloth: &Cloth) -> f64 {
        match self.material {
            Some(_) => cloth.spacing_m,
            None => RECORDED_SPACING_M,
        }
    }
}

/// What happens where twins and camera disagree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Distrusted {
    /// In a simulated world, the step is taken without rehearsal. Elsewhere nothing moves, and the rollout ends.
    StandsAside,
    /// Nothing moves in any world, and the rollout ends.
    Refuses,
}

/// What is measured on a twin after a candidate's fold; more is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RehearsalMeasure {
    /// How much the twin's silhouette overlaps with that of the next subgoal, from 0 to 1.
    Overlap,
    /// How much of its flat area the twin covers, as a fraction.
    Coverage,
}

words!(RehearsalMeasure {
    "overlap" => Overlap, "the overlap of the twin's silhouette with that of the next subgoal, from 0 to 1";
    "coverage" => Coverage, "the area that the twin covers, divided by what it covers where it lies flat";
});
