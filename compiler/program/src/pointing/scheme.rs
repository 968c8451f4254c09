//! How points are given to a model: by coordinates in a frame, or by numbers.

use super::frame::{Frame, Order};
use crate::data::actions::Choices;
use crate::data::camera::Camera;
use crate::data::program::Program;
use crate::data::stage::{Read, Stage};

/// How points are given to a model, and how it states them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pointing {
    /// By their coordinates.
    Frame(Frame),
    /// By numbers: the points that the action's fields offer are numbered from 1, in the order in which the fields
    /// list them, each once. Prompts write `3 at (41, 167)`, with the position in this frame; answers state `3`.
    Marks(Frame),
}

impl Pointing {
    /// Returns the notation in which tasks are written: `(x, y)` in pixels of the camera's picture,
    /// `[width, height]`.
    pub fn pixels(size: [u32; 2]) -> Pointing {
        Pointing::Frame(Frame::pixels(size))
    }

    /// Returns the same for the picture of a task's own camera, which is square.
    pub fn of_camera(camera: &Camera) -> Pointing {
        Pointing::pixels([camera.image_px; 2])
    }

    /// Returns the frame of the coordinates that prompts show.
    pub fn frame(&self) -> &Frame {
        match self {
            Pointing::Frame(frame) | Pointing::Marks(frame) => frame,
        }
    }

    /// Returns whether points are written as in tasks: in pixels of the camera's picture.
    pub fn is_native(&self) -> bool {
        matches!(self, Pointing::Frame(frame) if frame.is_native())
    }

    /// Returns the form of a point in the answer's format: `(x, y)`, `[y, x]` or `number`.
    pub fn form(&self) -> &'static str {
        match self {
            Pointing::Frame(frame) => frame.form(),
            Pointing::Marks(_) => "number",
        }
    }

    /// Describes how a point is written, e.g. `(x, y) in pixels`. This replaces `{{ actions.points }}`.
    pub fn phrase(&self) -> String {
        match self {
            Pointing::Frame(frame) => frame.phrase(),
            Pointing::Marks(frame) => {
                format!("as its number and its place, {}", frame.phrase())
            }
        }
    }

    /// Describes how a point is written, as a whole sentence.
    pub fn sentence(&self) -> String {
        let zero = match self.frame().order {
            Order::Xy => "(0, 0)",
            Order::Yx => "[0, 0]",
        };
        format!(
            "A point is written {}: x grows to the right, y grows downwards, and {zero} is the top left of the picture.",
            self.phrase()
        )
    }

    /// Returns why a stage cannot be asked in this way; pixels of the camera's picture always work.
    pub fn check(&self, program: &Program, stage: &Stage) -> Result<(), PointingError> {
        if self.is_native() || !matches!(stage.read, Read::Action) {
            return Ok(());
        }
        if !stage.examples.is_empty() && program.actions.iter().any(|field| field.is_point()) {
            return Err(PointingError::LiteralExamples {
                stage: stage.name.clone(),
                wanted: self.phrase(),
            });
        }
        let regions = program.actions.iter().filter_map(|field| {
            let Choices::Region { mask } = &field.choices else {
                return None;
            };
            Some((field.name.clone(), mask.clone()))
        });
        match (self, regions.into_iter().next()) {
            (Pointing::Marks(_), Some((field, mask))) => {
                Err(PointingError::UncountedPoints { field, mask })
            }
            _ => Ok(()),
        }
    }
}

/// Why a task cannot be used with a model's way of giving points.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PointingError {
    /// A field may be any point of a mask, but points are to be numbered.
    #[error(
        "the field `{field}` may be any point of `{mask}`, and those cannot be numbered; offer keypoints \
         (`{field}: one of …`), or choose a model that answers in coordinates"
    )]
    UncountedPoints {
        /// The field.
        field: String,
        /// The mask.
        mask: String,
    },
    /// A stage's own examples state points in pixels, as the author wrote them.
    #[error(
        "the examples of stage `{stage}` state points in pixels, as the task has them, and this model writes a point \
         {wanted}; use `demos`, which are written in every frame, or a model that answers in pixels"
    )]
    LiteralExamples {
        /// The stage.
        stage: String,
        /// How points would have to be written.
        wanted: String,
    },
}
