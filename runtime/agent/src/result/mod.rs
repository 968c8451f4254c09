//! Whether a step led to where the next subgoal picture shows the cloth.
//!
//! In: silhouettes, of the cloth in the rollout and in the subgoal pictures. Out: a share. Cloths of other size
//! and turn are compared, and so are mirrored executions of a fold; what lies within the silhouette is not
//! looked at. What follows from the share is decided elsewhere.

mod overlap;
mod silhouette;

pub use overlap::{Alignment, overlap};
pub use silhouette::silhouette;

use crate::scene::{Scene, SceneError};
use crate::subgoals::SubgoalSet;
use fab_picture::observation::Observation;
use fab_program::Program;
use serde::{Deserialize, Serialize};

/// What a step came to, beside the subgoal that it was to lead to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepResult {
    /// The subgoal, from 1.
    pub subgoal: u32,
    /// Area of both silhouettes over the area of either, from 0 to 1.
    pub overlap: f64,
    /// Whether that is enough for the task.
    pub is_enough: bool,
}

impl StepResult {
    /// Looks at the cloth after a step.
    ///
    /// - `subgoal`: which one the step was to lead to, from 1.
    /// - `first`: the rollout's first scene, in which the cloth lies as in the first subgoal picture.
    ///
    /// `None` where the task does not compare, there is no such picture, or one of them shows no cloth; a cloth out
    /// of view is reported by the next step. Fails where a picture is too large or OpenCV fails.
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
