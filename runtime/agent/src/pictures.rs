//! The pictures that one step can show a model.
//!
//! In: what was drawn and taken, in the camera's size. Out: PNG files in the size that the model works on, the offered
//! points numbered on pictures of the scene where it is told of points so.

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
    /// The subgoals around the step, where the task has any.
    pub subgoals: Option<StepPictures>,
    /// What the camera sees.
    pub scene: RgbImage,
    /// The same with the task's layers drawn on it.
    pub annotated: RgbImage,
    /// What the stages are told as examples.
    pub examples: Examples,
}

impl Pictures {
    /// Draws the task's layers, and puts all that a step can show together.
    ///
    /// Fails where a layer cannot be drawn.
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
            annotated: scene.annotated(program, &observation.rgb, last)?,
            scene: observation.rgb.clone(),
            examples,
        })
    }

    /// Returns the size of the camera's picture, `[width, height]`.
    pub fn size(&self) -> [u32; 2] {
        self.scene.dimensions().into()
    }

    /// Returns a picture of a prompt as a model is sent it; None where there is none such, which only a program edited
    /// by hand asks for.
    pub fn png(
        &self,
        picture: &PromptPicture,
        lowering: &Lowering,
        notation: &Notation,
    ) -> Option<Png> {
        let encoded = |picture: &RgbImage| Png::new(png::encode(&lowering.resized(picture)));
        match picture {
            PromptPicture::File(file) => {
                let png = self.examples.picture(file)?;
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

/// Encodes a picture of the scene as a model is sent it: in its size, and with the numbers of the offered points where
/// they are numbered.
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
