//! Compares a step's result with the next subgoal picture.
//!
//! In: silhouettes of the cloth in the rollout and in the subgoal pictures. Out: their overlap. Cloths of different
//! size and rotation are comparable, and so are mirrored folds; the inside of the silhouette is ignored. What follows
//! from the overlap is decided elsewhere.

mod overlap;
mod silhouette;

pub use overlap::{Alignment, overlap};
pub use silhouette::silhouette;

use crate::scene::{Scene, SceneError};
use crate::subgoals::SubgoalSet;
use fab_picture::observation::Observation;
use fab_program::Program;
use serde::{Deserialize, Serialize};

/// The result of a step compared with its subgoal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepResult {
    /// The subgoal, from 1.
    pub subgoal: u32,
    /// Intersection over union of both silhouettes, from 0 to 1.
    pub overlap: f64,
    /// Whether that is enough for the task.
    pub is_enough: bool,
}

impl StepResult {
    /// Compares the cloth after a step.
    ///
    /// - `subgoal`: the subgoal of the step, from 1.
    /// - `first`: the rollout's first scene, in which the cloth lies as in the first subgoal picture.
    ///
    /// `None` if the task does not compare, there is no such picture, or one of them shows no cloth; the next step
    /// reports a cloth out of view. Fails if a picture is too large.
    pub fn of(
        program: &Program,
        subgoals: &SubgoalSet,
        subgoal: u32,
        first: &Scene,
        after: &Observation,
    ) -> Result<Option<StepResult>, SceneError> {
        let Some(check) = &program.verify.result else {
            return Ok(None);
        };
        let pictures = &subgoals.pictures;
        let (Some(unfolded), Some(goal)) = (pictures.first(), pictures.get(subgoal as usize))
        else {
            return Ok(None);
        };
        let (Some(cloth), Some(after)) = (first.cloth(), Scene::cloth_in(program, after)?) else {
            return Ok(None);
        };
        let Some(alignment) = Alignment::of(cloth, &silhouette(unfolded))? else {
            return Ok(None);
        };
        let overlap = overlap(&after, &silhouette(goal), &alignment);
        Ok(Some(StepResult {
            subgoal,
            overlap,
            is_enough: overlap > check.overlap_above,
        }))
    }
}

#[cfg(test)]
mod tests;
