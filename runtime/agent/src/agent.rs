//! Decides one step: asks, reads, judges, and asks again with the reason of the refusal.
//!
//! In: the program, the scene, the step's pictures, the models. Out: every attempt as it happens, and
//! a [`Decision`]. The number of questions is bounded by the program's `attempts` per stage. Nothing
//! here moves anything.

mod asking;
mod conversation;
mod judge;
mod reach;
mod rehearsal;
mod talk;

use crate::demos::DemosError;
use crate::outcome::Outcome;
use crate::pictures::Pictures;
use crate::result::StepResult;
use crate::scene::Scene;
pub use asking::{Asking, Step};
pub use conversation::{Conversation, PromptError, Spoken, SpokenPart, conversation, opening};
use fab_model::calls::{CallRefused, Fault};
use fab_model::{Models, Reply, Request};
use fab_picture::observation::Observation;
use fab_program::Proposal;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::Pointing;
use fab_program::render::RenderError;
use fab_program::verify::Verdict;
use fab_program::{Exhausted, Program, Value};
use fab_world::Reach;
pub use rehearsal::{Rehearsed, rehearse};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Duration;
use talk::{Answer, Missing, Next, Talk};

/// One question, its answer, and what came of it.
#[derive(Clone, Debug)]
pub struct Attempt {
    /// The stage that asked.
    pub stage: String,
    /// Which question of this stage and step it was, from 1.
    pub number: u32,
    /// What was sent.
    pub request: Request,
    /// What came back, where something did.
    pub reply: Option<Reply>,
    /// What it meant.
    pub finding: Finding,
    /// How long the model took.
    pub took: Duration,
}

/// What an answer meant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "finding", rename_all = "snake_case")]
pub enum Finding {
    /// A text for later stages.
    Text {
        /// The variable it fills.
        name: String,
        /// The text.
        value: String,
        /// What had to be tolerated to read it.
        repairs: Vec<String>,
    },
    /// An action, and whether it may run.
    Action {
        /// Its fields.
        fields: Vec<(String, Value)>,
        /// What had to be tolerated to read it.
        repairs: Vec<String>,
        /// The verifier's answer.
        verdict: Verdict,
    },
    /// The answer could not be read.
    Malformed {
        /// What was looked for.
        field: String,
        /// What the model is told.
        message: String,
    },
    /// There was no answer.
    Failed {
        /// What the rollout ends with.
        outcome: Outcome,
        /// What went wrong with the last call, where one was made.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fault: Option<Fault>,
        /// Why.
        why: String,
    },
}

/// What is to be done in a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Decision {
    /// Execute this.
    Act {
        /// The action.
        proposal: Proposal,
        /// Which answer it is.
        accepted: Accepted,
    },
    /// Do nothing in this step, and go on; the rollout would have ended so.
    Skip(Outcome),
    /// End the rollout so.
    Stop(Outcome),
}

/// Which answer was taken in the end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accepted {
    /// The stage that asked for it.
    pub stage: String,
    /// Which question of that stage and step it answered, from 1.
    pub attempt: u32,
    /// The checks that were left out, all questions being used up; empty where it passes every check.
    pub without: Vec<String>,
}

/// Why a step could not even be asked.
#[derive(Debug, thiserror::Error)]
pub enum AgentError<E> {
    /// A template and its values do not fit; only a program edited by hand can do that.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The demonstrations cannot be told.
    #[error(transparent)]
    Demos(#[from] DemosError),
    /// An answer could not be kept, or is lost: nothing further may be asked.
    #[error(transparent)]
    Calls(CallRefused),
    /// The caller could not keep an attempt.
    #[error(transparent)]
    Record(E),
}

/// Where a step stands when models are asked.
#[derive(Clone, Copy)]
pub struct Situation<'a> {
    /// The task.
    pub program: &'a Program,
    /// What the camera shows.
    pub scene: &'a Scene,
    /// The picture that it was found in.
    pub observation: &'a Observation,
    /// Which action of the rollout this is, from 1; the same step may take several.
    pub number: u32,
    /// Which step this is, from 1.
    pub step: u32,
    /// What the action before came to, where it was for the same step.
    pub before: Option<StepResult>,
    /// The action before.
    pub last: Option<&'a ExecutedAction>,
    /// What can be shown.
    pub pictures: &'a Pictures,
    /// What is out of reach of the world that is to act.
    pub reach: &'a Reach<'a>,
    /// Tells apart runs that want independent answers; goes into every request.
    pub repetition: u32,
}

impl<'a> Situation<'a> {
    fn facts<'t>(self, texts: &'t BTreeMap<String, String>, pointing: Pointing) -> Facts<'t>
    where
        'a: 't,
    {
        Facts {
            scene: self.scene,
            texts,
            step: self.step,
            last: self.last,
            proposal: None,
            pointing,
        }
    }
}

impl<E> From<PromptError> for AgentError<E> {
    fn from(error: PromptError) -> Self {
        match error {
            PromptError::Render(error) => AgentError::Render(error),
            PromptError::Demos(error) => AgentError::Demos(error),
        }
    }
}

/// Asks every stage of one step and returns what to do.
///
/// `record` gets each attempt as soon as it is complete; where it fails, the step ends with its error.
pub fn decide<E: std::error::Error>(
    situation: Situation<'_>,
    models: Models<'_>,
    asking: &mut Asking<'_>,
    record: &mut dyn FnMut(&Attempt) -> Result<(), E>,
) -> Result<Decision, AgentError<E>> {
    let program = situation.program;
    let mut texts = BTreeMap::new();
    let mut decision = Decision::Stop(Outcome::MalformedReply);
    for stage in &program.stages {
        let model = models.of(stage.model);
        let mut talk = Talk::begin(
            situation,
            stage,
            &texts,
            model.lowering(),
            Missing::IsAnError,
        )?;
        let answer = loop {
            let attempt = talk.ask(model, asking, &texts)?;
            record(&attempt).map_err(AgentError::Record)?;
            match talk.conclude(attempt, &texts)? {
                Next::AskAgain => {}
                Next::ExecutedAction(answer) => break answer,
            }
        };
        match answer {
            Answer::Text { name, value } => {
                texts.insert(name, value);
            }
            Answer::Action { proposal, accepted } => {
                decision = Decision::Act { proposal, accepted };
            }
            Answer::None(outcome) => return Ok(without_answer(program, outcome)),
        }
    }
    Ok(decision)
}

/// Returns what becomes of a step without an answer: only what a model can do wrong is ever skipped.
fn without_answer(program: &Program, outcome: Outcome) -> Decision {
    match (program.verify.exhausted, outcome) {
        (Exhausted::Skips, Outcome::AttemptsExhausted | Outcome::MalformedReply) => {
            Decision::Skip(outcome)
        }
        _ => Decision::Stop(outcome),
    }
}
