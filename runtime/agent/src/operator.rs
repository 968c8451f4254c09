//! What the person beside an arm says of a rollout that has ended.
//!
//! In: the rollout's report. Out: a [`Judgement`], which the journal keeps in its last line. On a real table nobody knows where the
//! cloth's particles are, so a fold is judged by a person, as in the paper. Who asks, and how, is the caller's business;
//! nothing here prints.

use crate::outcome::Outcome;
use crate::rollout::RolloutReport;
use serde::{Deserialize, Serialize};

/// What a person says of a rollout.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Judgement {
    /// Whether the task was reached.
    pub reached: bool,
    /// Why not, where it was not.
    pub why: Option<Cause>,
    /// The same in the person's own words, where there were any.
    pub words: Option<String>,
}

/// Why a rollout did not reach its task: the paper's three kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The arm, its gripper or the camera: a grasp that missed or took two layers, a motion that failed.
    Hardware,
    /// What was found in the picture: corners or the cloth itself.
    Detection,
    /// What the model chose.
    Reasoning,
}

impl Cause {
    /// All of them.
    pub const ALL: [Cause; 3] = [Cause::Hardware, Cause::Detection, Cause::Reasoning];

    /// Returns its name in journals and tables.
    pub fn name(self) -> &'static str {
        match self {
            Cause::Hardware => "hardware",
            Cause::Detection => "detection",
            Cause::Reasoning => "reasoning",
        }
    }
}

/// Somebody who says what came of a rollout.
pub trait Operator: Sync {
    /// Returns what the operator says of a rollout; none where nobody answers, which is kept as such.
    ///
    /// Asked once, when everything else of the report is known, and never again when the run folder is read.
    fn judge(&self, report: &RolloutReport) -> Option<Judgement>;
}

/// Returns whether there is something to judge: not where the rollout was broken off for want of a model or of time, or only planned.
pub(crate) fn is_judged(outcome: Outcome) -> bool {
    !matches!(
        outcome,
        Outcome::Interrupted | Outcome::BudgetExhausted | Outcome::ModelFailed | Outcome::Planned
    )
}
