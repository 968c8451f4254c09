//! Compares a step's result with the next subgoal picture.
//!
//! In: silhouettes of the cloth in the rollout and in the subgoal pictures. Out: their overlap. Cloths of different
//! size and rotation are comparable, and so are mirrored folds; the inside of the silhouette is ignored. What follows
//! from the overlap is decided elsewhere.

mod silhouette;

pub use silhouette::silhouette;

use crate::scene::{Scene, SceneError};
use crate::subgoals::SubgoalSet;
use fab_picture::observation::Observation;
use fab_picture::{Mask, SubpixelPoint};
use fab_program::Program;
use fab_vision::{Rectangle, VisionError};
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

/// Rectangles whose sides differ by less than this factor count as squares.
///
/// The outlines of turned squares differ by up to 2 %; the paper's rectangles have sides of 5 to 4.
const SQUARE: f64 = 1.1;

/// Approximate number of samples along the picture's side; more would not change the overlap by a hundredth.
const SAMPLES: u32 = 128;

/// All transforms that bring the cloth of one picture onto the cloth of another by their rectangles.
///
/// A silhouette does not show which corner is which, so a step is right if any of these transforms says so.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    from: Rectangle,
    onto: Rectangle,
    ways: Vec<AxisMap>,
}

/// A symmetry of a rectangle: which axis of one rectangle becomes which of the other, and the signs of both.
type AxisMap = ([usize; 2], [f64; 2]);

impl Alignment {
    /// Aligns an unfolded cloth with the unfolded cloth of the subgoal pictures.
    ///
    /// `None` if either is empty. Fails if a mask is larger than a picture may be.
    pub fn of(cloth: &Mask, shown: &Mask) -> Result<Option<Alignment>, VisionError> {
        let (Some(from), Some(onto)) = (
            fab_vision::rectangle_around(cloth)?,
            fab_vision::rectangle_around(shown)?,
        ) else {
            return Ok(None);
        };
        let is_square = |rectangle: &Rectangle| rectangle.sides[0] < SQUARE * rectangle.sides[1];
        let orders: &[[usize; 2]] = if is_square(&from) && is_square(&onto) {
            &[[0, 1], [1, 0]]
        } else {
            &[[0, 1]]
        };
        let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
        let ways = orders
            .iter()
            .flat_map(|&order| signs.map(|signs| (order, signs)));
        Ok(Some(Alignment {
            from,
            onto,
            ways: ways.collect(),
        }))
    }

    /// Maps a point of the subgoal picture to the other one, both `[column, row]`, pixels.
    fn back(&self, (order, signs): AxisMap, [column, row]: [f64; 2]) -> [f64; 2] {
        let (from, onto) = (&self.from, &self.onto);
        let off = [column - onto.center[0], row - onto.center[1]];
        let across = |along: [f64; 2]| [-along[1], along[0]];
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let shares = [
            dot(off, onto.along) / onto.sides[0] * signs[0],
            dot(off, across(onto.along)) / onto.sides[1] * signs[1],
        ];
        from.point(order.map(|axis| shares[axis]))
    }
}

/// Returns the intersection over union of two silhouettes, from 0 to 1.
///
/// - `after`: the cloth after a step; `goal`: the cloth of the next subgoal picture.
/// - `alignment`: of the unfolded cloths in the same two kinds of picture. The best of its transforms counts.
///
/// 0 if a silhouette is empty. The work is bounded for any picture size.
pub fn overlap(after: &Mask, goal: &Mask, alignment: &Alignment) -> f64 {
    let shares = alignment.ways.iter().map(|&way| {
        fab_picture::overlap(samples(goal).map(|at| {
            let in_after = after.contains(SubpixelPoint::at(alignment.back(way, at)).pixel);
            (goal.contains(SubpixelPoint::at(at).pixel), in_after)
        }))
    });
    shares.fold(0.0, f64::max)
}

/// Points on a grid over a picture plus half its width around it, which a turned cloth may reach.
fn samples(picture: &Mask) -> impl Iterator<Item = [f64; 2]> {
    let (width, height) = (picture.width(), picture.height());
    let step = width.max(height).div_ceil(SAMPLES).max(1) as usize;
    let range = move |side: u32| (-i64::from(side / 2)..i64::from(side) * 3 / 2).step_by(step);
    let half = step as f64 / 2.0;
    range(height).flat_map(move |row| {
        range(width).map(move |column| [column as f64 + half, row as f64 + half])
    })
}

#[cfg(test)]
mod tests;
