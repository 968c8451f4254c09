//! Where a stage's in-context examples come from.

use crate::data::files::FileRef;
use serde::{Deserialize, Serialize};

/// Demonstrations of the task, shown to a stage's model before its own question.
///
/// The file holds observations and choices, not texts. The task's own templates and format write each question and
/// answer when they are needed, so an example always has the same form as the real question.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Demos {
    /// The stage; it reads the action and shows no pictures.
    pub stage: String,
    /// The file.
    pub file: FileRef,
}
