//! The pictures that one step can show a model.

use crate::examples::Examples;
use crate::model::Png;
use crate::picture;
use crate::subgoals::StepPictures;
use compiler::program::{Layers, Picture};
use compiler::render::PromptPicture;
use image::RgbImage;

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
    /// Returns a picture of a prompt, encoded; None where there is none such, which only a program edited by
    /// hand asks for.
    pub fn png(&self, picture: &PromptPicture) -> Option<Png> {
        let encoded = |picture: &RgbImage| Png::new(picture::encode(picture));
        match picture {
            PromptPicture::File(file) => self.examples.picture(file).cloned(),
            PromptPicture::Drawn(Picture::Subgoal { which, arrow }) => {
                let subgoals = self.subgoals.as_ref()?;
                Some(encoded(subgoals.picture(*which, *arrow)))
            }
            PromptPicture::Drawn(Picture::Scene { layers }) => Some(match layers {
                Layers::Drawn => encoded(&self.annotated),
                Layers::Absent => encoded(&self.scene),
            }),
        }
    }
}
