//! Why something could not be run, searched, drawn or stored.

use crate::scene::SceneError;
use fab_program::render::RenderError;
use fab_vision::VisionError;
use fab_world::WorldError;
use std::io;
use std::path::Path;

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The world failed, or a stop was requested.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The picture gives nothing to ask about.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A template and its values do not match, or a stage does not support the model's point convention.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A picture cannot be drawn on.
    #[error(transparent)]
    Vision(#[from] VisionError),
    /// A thread cannot be started.
    #[error(transparent)]
    Threads(#[from] io::Error),
    /// Something was asked for that cannot be done: the task, the policy, the world or the options do not fit each other.
    #[error("{0}")]
    Unfit(String),
    /// A file, a picture or an answer cannot be used or stored.
    #[error("{0}")]
    Failed(String),
}

impl RunError {
    /// Keeps the message of an error that nobody tells apart from others.
    pub(crate) fn failed(error: impl ToString) -> RunError {
        RunError::Failed(error.to_string())
    }

    pub(crate) fn unwritable(path: &Path, error: io::Error) -> RunError {
        RunError::Failed(format!("cannot write `{}`: {error}", path.display()))
    }
}
