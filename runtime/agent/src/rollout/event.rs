//! What happens in a rollout, as it happens: the command prints it, writes it as lines of JSON, or shows it on a page.
//!
//! Files are named relative to the run folder. A resumed rollout repeats the events of its earlier part.

use super::Ended;
use crate::record::{Asked, Header, SentFiles, Step, StepSpent};
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
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// The stage that asks; `policy` where the policy has no stages.
        stage: String,
        /// The attempt's number within this stage and step, from 1.
        attempt: u32,
        /// The question.
        #[serde(flatten)]
        sent: SentFiles,
    },
    /// An answer came.
    Answer {
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// The stage that asked.
        stage: String,
        /// The attempt's number.
        attempt: u32,
        /// Its text.
        text: String,
        /// How long it took, seconds.
        took_s: f64,
    },
    /// An answer was judged, or none came.
    Verdict {
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// The question, the answer's file, what it means, and whether it may run.
        #[serde(flatten)]
        asked: Box<Asked>,
    },
    /// A step is over: its motion was executed, it was skipped, or it ends the rollout.
    Motion {
        /// When in the rollout.
        #[serde(flatten)]
        at: At,
        /// Its line in the record.
        line: Box<Step>,
        /// What it took.
        spent: Box<StepSpent>,
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

/// A moment of a rollout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct At {
    /// The action in the rollout, from 1, as in the names of its files.
    pub action: u32,
    /// The task's step that the action is for, from 1.
    pub step: u32,
}
