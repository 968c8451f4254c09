//! The pictures that one step can show to a model.
//!
//! In: drawn pictures and camera pictures, in the camera's size. Out: PNG files in the size that the model works on;
//! the offered points are numbered on pictures of the scene if the model gets points as numbers.

use crate::examples::Examples;
use crate::scene::{Scene, SceneError};
use crate::subgoals::StepPictures;
use fab_model::{Lowering, Png};
use fab_picture::observation::Observation;
use fab_picture::png;
use fab_program::facts::ExecutedAction;
use fab_program::pointing::Notation;
use fab_program::render::PromptPicture;
use fab_program::{Layers, Picture, Program};
use image::{ImageFormat, RgbImage};

/// The pictures of one step.
#[derive(Clone, Debug)]
pub struct Pictures {
    /// The subgoals around the step, if the task has any.
    pub subgoals: Option<StepPictures>,
    /// The camera's picture.
    pub scene: RgbImage,
    /// The camera's picture with the task's layers.
    pub annotated: RgbImage,
    /// The examples of the stages.
    pub examples: Examples,
}

impl Pictures {
    /// Draws the task's layers, and collects everything that a step can show.
    ///
    /// Fails if a layer cannot be drawn.
    pub fn of(
        program: &Program,
        scene: &Scene,
        observation: &Observation,
        last: Option<&ExecutedAction>,
        subgoals: Option<StepPictures>,
        examples: Examples,
    ) -> Result<Pictures, SceneError> {
        Ok(Pictures {
            subgoals,
            annotated: scene.annotated(program, &program.layers, &observation.rgb, last)?,
            scene: observation.rgb.clone(),
            examples,
        })
    }

    /// Returns the size of the camera's picture, `[width, height]`.
    pub fn size(&self) -> [u32; 2] {
        self.scene.dimensions().into()
    }

    /// Returns a picture of a prompt as sent to a model; `None` if there is no such picture, which happens only in a
    /// hand-edited program.
    pub fn png(
        &self,
        picture: &PromptPicture,
        lowering: &Lowering,
        notation: &Notation,
    ) -> Option<Png> {
        let encoded = |picture: &RgbImage| Png::new(png::encode(&lowering.resized(picture)));
        match picture {
            PromptPicture::File(file) => {
                let png = self.examples.pictures.get(&file.path)?;
                if *lowering == Lowering::PIXELS {
                    return Some(png.clone());
                }
                let decoded = image::load_from_memory_with_format(png.bytes(), ImageFormat::Png);
                decoded.ok().map(|picture| encoded(&picture.into_rgb8()))
            }
            PromptPicture::Drawn(Picture::Subgoal { which, arrow }) => {
                let subgoals = self.subgoals.as_ref()?;
                Some(encoded(subgoals.picture(*which, *arrow)))
            }
            PromptPicture::Drawn(Picture::Scene { layers }) => {
                let scene = match layers {
                    Layers::Drawn => &self.annotated,
                    Layers::Absent => &self.scene,
                };
                Some(scene_png(scene, lowering, notation))
            }
        }
    }
}

/// Encodes a picture of the scene for sending to a model: in its size, with the offered points numbered if it gets
/// points as numbers.
pub fn scene_png(picture: &RgbImage, lowering: &Lowering, notation: &Notation) -> Png {
    let mut sent = lowering.resized(picture).into_owned();
    let frame = notation.pointing().frame();
    let places: Vec<[f64; 2]> = notation
        .marks()
        .iter()
        .map(|point| frame.in_sent_picture(*point))
        .collect();
    fab_vision::draw_numbers(&mut sent, &places);
    Png::new(png::encode(&sent))
}
