//! Finds and draws a task's keypoints and layers on a user's picture; no world, no model.
//!
//! In: a program and pictures. Out: the [`Scene`] of a rollout's first step there, and a picture of each stage.
//! Extractors and layers are the same as in a rollout.

use crate::error::RunError;
use crate::scene::Scene;
use fab_picture::DepthImage;
use fab_picture::observation::Observation;
use fab_program::Proposal;
use fab_program::facts::ExecutedAction;
use fab_program::{Layer, PixelPoint, Program};
use image::RgbImage;

/// The user's input.
#[derive(Clone, Debug)]
pub struct SeeInput {
    /// Colour, in any size; the middle square is what the task's camera shows.
    pub rgb: RgbImage,
    /// Depth of the same shape, metres; 0 means no reading.
    pub depth_m: Option<DepthImage>,
    /// Where the previous action placed the cloth, for layers that show it.
    pub last_place: Option<PixelPoint>,
}

/// The result.
#[derive(Clone, Debug)]
pub struct SeeOutput {
    /// The keypoints.
    pub scene: Scene,
    /// A picture of each keypoint and of each layer, with its name, in their order.
    pub stages: Vec<(String, RgbImage)>,
    /// The picture that a model would get.
    pub annotated: RgbImage,
    /// Layers that show the previous action, where its place is unknown or they need its pick.
    pub left_out: Vec<String>,
    /// What the pictures lack, and what was done about it.
    pub notes: Vec<String>,
}

/// Finds every keypoint in a picture, and draws every layer.
pub fn see(program: &Program, brought: SeeInput) -> Result<SeeOutput, RunError> {
    let mut keypoints = program.keypoints.iter();
    let by_depth = keypoints.find(|it| it.extractor.needs_depth());
    if let (None, Some(keypoint)) = (&brought.depth_m, by_depth) {
        return Err(RunError::Unfit(format!(
            "`{}` needs depth, but the picture has none; use `mask(hue: …, saturation: …, value: …)`, and detectors with `of: mask` or `of: picture`",
            keypoint.name
        )));
    }
    let is_known = brought.last_place.is_some();
    let is_left_out = |layer: &Layer| layer.uses_last_pick() || (layer.uses_last() && !is_known);
    let mut program = program.clone();
    let left_out = program.layers.extract_if(.., |layer| is_left_out(layer));
    let left_out = left_out.map(|layer| layer.name).collect();
    let last = brought.last_place.map(|place| ExecutedAction {
        proposal: Proposal { fields: Vec::new() },
        // No layer that is left shows the pick.
        pick: place,
        place,
    });
    let observation = Observation::of_picture(&program.camera, brought.rgb, brought.depth_m);
    let mut observation = observation.map_err(RunError::failed)?;
    let scene = Scene::of(&program, &observation, None)?;
    observation.notes.extend(scene.beyond_the_picture());
    Ok(SeeOutput {
        stages: scene.stages(&program, &observation.rgb, last.as_ref())?,
        annotated: scene.annotated(&program, &program.layers, &observation.rgb, last.as_ref())?,
        left_out,
        notes: observation.notes,
        scene,
    })
}
