//! Where a stage's in-context examples come from.

use crate::data::files::FileRef;
use serde::{Deserialize, Serialize};

/// Demonstrations of the task that a stage's model is told before its own question.
///
/// The file holds what was seen and chosen, and not texts: question and answer are written by the task's own
/// templates and format when they are told, so that an example never differs from what is asked.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Demos {
    /// The stage; it reads the action and shows no pictures.
    pub stage: String,
    /// The file.
    pub file: FileRef,
}
