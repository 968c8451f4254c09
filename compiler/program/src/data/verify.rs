//! The checks on a proposed action, as data.
//!
//! [`crate::verify`] evaluates them, [`crate::render`] renders their messages.

use crate::data::values::Condition;
use serde::{Deserialize, Serialize};

/// The checks on a proposed action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verify {
    /// In order; the first one that fails gives the message.
    pub checks: Vec<Check>,
    /// The most questions per stage and step, at least 1 (the paper: three).
    pub attempts: u32,
    /// Checks to remove when the answers to all questions are judged once more, newest first.
    pub relaxed: Vec<String>,
    /// Whether a question after a rejection shows the rejected action on the picture; for stages with a vision model.
    pub with_picture: bool,
    /// What happens after a step whose last answer was rejected or unreadable.
    pub exhausted: Exhausted,
    /// The condition on a step's result, if the task states one.
    pub result: Option<ResultCheck>,
}

/// The condition on a step's result; if it fails, the model is asked again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResultCheck {
    /// The silhouettes of the cloth and of the next subgoal, aligned, must overlap by more than this: the area of
    /// their intersection over that of their union, from 0 to 1.
    pub overlap_above: f64,
    /// The most further actions per step.
    pub retries: u32,
    /// Template of the message to the model; it may name [`OVERLAP`].
    pub message: String,
}

/// The name under which the message of a [`ResultCheck`] refers to the overlap, in percent.
pub const OVERLAP: &str = "overlap";

/// What happens after a step without an accepted answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Exhausted {
    /// The rollout ends.
    Ends,
    /// Nothing moves, the step counts as an action, and the rollout goes on.
    Skips,
}

/// One check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Its name in the task and in the journal.
    pub name: String,
    /// When the check applies; `None` means always.
    pub when: Option<Condition>,
    /// What must hold.
    pub holds: Condition,
    /// Template of the correction message.
    pub message: String,
}
