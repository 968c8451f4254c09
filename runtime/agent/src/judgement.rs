//! A person's judgement of a finished rollout: whether the task was reached, and why not.
//!
//! On a real table the positions of the cloth's particles are unknown, so a person judges a fold, as in the paper. The
//! caller decides who is asked, and how; nothing here prints.

use crate::record::Report;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Somebody who judges the result of a rollout.
pub trait Operator: Sync {
    /// Returns the operator's judgement of a rollout with the run folder `folder`; `None` if nobody answers, which is
    /// recorded as such.
    ///
    /// Asked once, when the rest of the report is known, and never again when the run folder is read.
    fn judge(&self, report: &Report, folder: &Path) -> Option<Judgement>;
}

/// A person's judgement of a rollout.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Judgement {
    /// Whether the task was reached.
    pub reached: bool,
    /// Why it was not reached, if so.
    pub why: Option<Cause>,
    /// The cause in the person's own words, if any.
    pub words: Option<String>,
}

fab_base::named! {
    /// Why a rollout did not reach its task: the paper's three categories.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    pub enum Cause {
        /// The arm, its gripper or the camera: a grasp that missed or took two layers, a motion that failed.
        Hardware = "hardware",
        /// What was detected in the picture: corners or the cloth itself.
        Detection = "detection",
        /// The model's choice.
        Reasoning = "reasoning",
    }
}
