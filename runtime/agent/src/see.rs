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
use fab_program::{Extractor, Layer, PixelPoint, Program, Sight};
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
    if brought.depth_m.is_none() {
        check_depth(program)?;
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
        annotated: scene.annotated(&program, &observation.rgb, last.as_ref())?,
        left_out,
        notes: observation.notes,
        scene,
    })
}

fn check_depth(program: &Program) -> Result<(), RunError> {
    let by_depth = |keypoint: &&fab_program::Keypoint| keypoint.extractor.needs_depth();
    let Some(keypoint) = program.keypoints.iter().find(by_depth) else {
        return Ok(());
    };
    let alternative = match &keypoint.extractor {
        Extractor::Corners {
            of: Sight::Depth, ..
        } => "a detector that looks at `of: mask` or `of: picture`",
        _ => "`mask(hue: …, saturation: …, value: …)`",
    };
    let name = &keypoint.name;
    Err(RunError::Unfit(format!(
        "`{name}` needs depth, but the picture has none; use {alternative} instead"
    )))
}
