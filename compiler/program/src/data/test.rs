//! The tests of a task or of a variant: an answer and the expected result.

use crate::data::camera::PixelPoint;
use serde::{Deserialize, Serialize};

/// One `test`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Test {
    /// Its name.
    pub name: String,
    /// The task that it belongs to.
    pub task: String,
    /// The variant that states it; `None` for the task itself.
    pub variant: Option<String>,
    /// What the scene shows, and what happened before.
    pub given: Given,
    /// The stage that is answered, by its index.
    pub stage: usize,
    /// The answer.
    pub reply: String,
    /// The expected result.
    pub expect: Expect,
    /// The file that declares it, as in [`crate::data::files::SourceStamp::name`].
    pub declared_in: String,
    /// The line where it begins, from 1.
    pub line: u32,
}

/// What the scene shows, and what happened before.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Given {
    /// Points, by keypoint.
    pub points: Vec<(String, Vec<PixelPoint>)>,
    /// Masks and boxes as upright rectangles, two opposite corners each, both included.
    pub regions: Vec<(String, [PixelPoint; 2])>,
    /// Texts that earlier stages read.
    pub texts: Vec<(String, String)>,
    /// Pick and place of the previous action.
    pub last: Option<[PixelPoint; 2]>,
    /// Which step it is, from 1.
    pub step: u32,
}

/// The expected result of an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "expect", rename_all = "snake_case")]
pub enum Expect {
    /// The action may run.
    Accept,
    /// A check rejects it.
    Reject {
        /// The check.
        check: String,
    },
    /// It cannot be read.
    Malformed,
    /// A text is read.
    Text {
        /// The text.
        text: String,
    },
}
