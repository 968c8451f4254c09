//! What a task finds and draws on a picture that a user brings; no world, no model.
//!
//! In: a program and pictures. Out: the [`Scene`] that a rollout's first step would have there, and a picture of each
//! stage. Extractors and layers are a rollout's own.

use crate::scene::{Scene, SceneError, StagePicture};
use fab_picture::DepthImage;
use fab_picture::observation::{Observation, WrongSize};
use fab_program::Proposal;
use fab_program::facts::ExecutedAction;
use fab_program::{End, Extractor, PixelPoint, Program, Sight};
use image::RgbImage;

/// What a user brings.
#[derive(Clone, Debug)]
pub struct Brought {
    /// Colour, of the size that the task's camera takes.
    pub rgb: RgbImage,
    /// Depth of the same size, metres; 0 means no reading.
    pub depth_m: Option<DepthImage>,
    /// Where the action before this one ended, for layers that show it.
    pub last: Option<LastAction>,
}

/// The action before this one, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LastAction {
    /// Where the cloth was picked, where that is known.
    pub pick: Option<PixelPoint>,
    /// Where it was placed.
    pub place: PixelPoint,
}

/// What is seen.
#[derive(Clone, Debug)]
pub struct Seen {
    /// The keypoints.
    pub scene: Scene,
    /// A picture of each keypoint and of each layer, in their order.
    pub stages: Vec<StagePicture>,
    /// What a model would be shown.
    pub annotated: RgbImage,
    /// Layers that need an action before this one, where there is none.
    pub left_out: Vec<String>,
}

/// Why nothing is seen.
#[derive(Debug, thiserror::Error)]
pub enum SeeError {
    /// A keypoint is found by depth.
    #[error(
        "`{keypoint}` is found by depth, and the picture comes without it ({right} needs none)"
    )]
    NeedsDepth {
        /// The keypoint.
        keypoint: String,
        /// What would do without.
        right: &'static str,
    },
    /// A layer shows where the last action picked.
    #[error(
        "the layer `{layer}` shows where the last action picked, which is not said beside its place"
    )]
    NeedsPick {
        /// The layer.
        layer: String,
    },
    /// A picture has another size than the camera's.
    #[error(transparent)]
    Size(#[from] WrongSize),
    /// A keypoint is not found, or a layer not drawn.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Finds every keypoint in a picture, and draws every layer.
pub fn see(program: &Program, brought: Brought) -> Result<Seen, SeeError> {
    if brought.depth_m.is_none() {
        check_depth(program)?;
    }
    let last = brought.last.map(|last| done(program, last)).transpose()?;
    let observation = Observation::of_picture(&program.camera, brought.rgb, brought.depth_m)?;
    let scene = Scene::of(program, &observation, None)?;
    let left_out = program
        .layers
        .iter()
        .filter(|layer| last.is_none() && layer.uses_last());
    Ok(Seen {
        stages: scene.stages(program, &observation.rgb, last.as_ref())?,
        annotated: scene.annotated(program, &observation.rgb, last.as_ref())?,
        left_out: left_out.map(|layer| layer.name.clone()).collect(),
        scene,
    })
}

fn check_depth(program: &Program) -> Result<(), SeeError> {
    let by_depth = |keypoint: &&fab_program::Keypoint| keypoint.extractor.needs_depth();
    let Some(keypoint) = program.keypoints.iter().find(by_depth) else {
        return Ok(());
    };
    let right = match &keypoint.extractor {
        Extractor::Corners {
            of: Sight::Depth, ..
        } => "a detector that looks at `of: mask` or `of: picture`",
        _ => "`mask(hue: …, saturation: …, value: …)`",
    };
    Err(SeeError::NeedsDepth {
        keypoint: keypoint.name.clone(),
        right,
    })
}

/// Makes the action that layers show; they know no more of it than its ends.
fn done(program: &Program, last: LastAction) -> Result<ExecutedAction, SeeError> {
    let of_pick = program
        .layers
        .iter()
        .find(|layer| layer.uses_end(End::Pick));
    match (last.pick, of_pick) {
        (None, Some(layer)) => Err(SeeError::NeedsPick {
            layer: layer.name.clone(),
        }),
        // Where no layer shows the pick, any pixel stands for it.
        (pick, _) => Ok(ExecutedAction {
            proposal: Proposal { fields: Vec::new() },
            pick: pick.unwrap_or(last.place),
            place: last.place,
        }),
    }
}
