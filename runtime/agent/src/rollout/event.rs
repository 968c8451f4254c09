//! What happens in a rollout, as it happens: the command prints it, writes it as lines of JSON, or shows it on a page.
//!
//! Files are named relative to the run folder. A resumed rollout repeats the events of its earlier part.

use super::Ended;
use crate::action::Action;
use crate::outcome::Outcome;
use crate::policy::Finding;
use crate::record::{Header, RehearsedStep, StepFiles};
use fab_model::calls::{Spent, Usage};
use fab_world::Executed;
use fab_world::metrics::ClothMoved;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// An event with its time and its rollout: one line of JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Time since the command began to listen, seconds.
    pub at_s: f64,
    /// The run folder.
    pub run: String,
    /// What happened.
    #[serde(flatten)]
    pub event: Event,
}

/// Something that happened in a rollout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// The rollout begins.
    Start {
        /// What is run, and on what.
        header: Box<Header>,
    },
    /// A picture was taken.
    Picture {
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// The picture.
        file: String,
        /// Its keypoints.
        scene: Value,
    },
    /// Something is about to be asked.
    Question {
        /// Which question.
        #[serde(flatten)]
        of: AttemptOf,
        /// The question's files.
        #[serde(flatten)]
        files: SentFiles,
    },
    /// An answer came.
    Answer {
        /// Which question it answers.
        #[serde(flatten)]
        of: AttemptOf,
        /// Its text.
        text: String,
        /// Its file.
        file: String,
        /// How long it took, seconds.
        took_s: f64,
        /// Token usage as reported by the provider.
        usage: Option<Usage>,
    },
    /// An answer was judged, or none came.
    Verdict {
        /// Which question it was.
        #[serde(flatten)]
        of: AttemptOf,
        /// The policy's note, for people.
        note: Option<String>,
        /// What the answer means, and whether it may run.
        result: Finding,
    },
    /// The answers of a step were tried on twins.
    Rehearsed {
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// What came of it.
        rehearsal: Box<RehearsedStep>,
        /// Time spent on the twins, seconds.
        took_s: f64,
    },
    /// A motion was executed.
    Motion {
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// What each gripper was to do.
        grips: Vec<Action>,
        /// The other values of the answer, as it states them: `lift 60 mm`.
        other_values: Vec<String>,
        /// The checks that were dropped to accept it.
        without: Vec<String>,
        /// What was really done.
        executed: Box<Executed>,
        /// How far it moved the cloth, if the world knows its particles.
        cloth: Option<ClothMoved>,
        /// The picture before it with the action drawn, the picture after it, and all positions, if the world knows them.
        files: Box<StepFiles>,
        /// Wall time of the whole step, seconds.
        took_s: f64,
        /// What the rollout's calls added up to so far.
        spent: Spent,
    },
    /// A step had no action, and the rollout goes on.
    Skipped {
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// The outcome that the rollout would have ended with.
        why: Outcome,
    },
    /// A step's result does not match its subgoal, so it is taken again.
    Retried {
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// The overlap with the subgoal, from 0 to 1.
        overlap: f64,
        /// What it must exceed.
        limit: f64,
    },
    /// The rollout ends in an unfinished step.
    Stopped {
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// Why, in words.
        why: String,
    },
    /// Expert results must be simulated for the score.
    Experts {
        /// How many.
        missing: usize,
        /// Of how many.
        total: usize,
    },
    /// Something that the user should know, without effect on the result.
    Note {
        /// In words.
        note: String,
    },
    /// The rollout ended.
    End {
        /// Its figures, as `fabc run --json` prints them.
        report: Box<Ended>,
    },
}

impl AttemptOf {
    pub(crate) fn new(at: At, stage: &str, attempt: u32) -> AttemptOf {
        AttemptOf {
            at,
            stage: stage.to_owned(),
            attempt,
        }
    }

    /// Returns what the names of its files begin with.
    pub(crate) fn stem(&self) -> String {
        let At { action, .. } = self.at;
        format!("step_{action}/{}_{}", self.stage, self.attempt)
    }
}

/// The files of a question.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SentFiles {
    /// The question as sent.
    pub request: Option<String>,
    /// The question in readable form, if it is a prompt.
    pub prompt: Option<String>,
}

/// A moment of a rollout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct At {
    /// The action in the rollout, from 1, as in the names of its files.
    pub action: u32,
    /// The task's step that the action is for, from 1.
    pub step: u32,
}

impl Event {
    /// Returns when in the rollout it happened, if within an action.
    pub fn at(&self) -> Option<At> {
        match self {
            Event::Picture { at, .. }
            | Event::Rehearsed { at, .. }
            | Event::Motion { at, .. }
            | Event::Skipped { at, .. }
            | Event::Retried { at, .. }
            | Event::Stopped { at, .. } => Some(*at),
            Event::Question { of, .. } | Event::Answer { of, .. } | Event::Verdict { of, .. } => {
                Some(of.at)
            }
            Event::Start { .. }
            | Event::Experts { .. }
            | Event::Note { .. }
            | Event::End { .. } => None,
        }
    }
}

/// One question of a step.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AttemptOf {
    /// When in the rollout.
    #[serde(flatten)]
    pub at: At,
    /// The stage that asked; `policy` where the policy has no stages.
    pub stage: String,
    /// Its number within this stage and step, from 1.
    pub attempt: u32,
}
