//! Policies: the deciders of each step, behind one trait.
//!
//! In: a [`StepView`], the rollout's state at a step. Out: a [`Decision`]: grips to execute, or why there are none.
//! [`Prompted`] asks models as the task's stages say; [`Random`] draws from the offered choices; [`Expert`] follows the
//! task's own demonstration; [`Onnx`] plays a network; [`External`] is a user's program. Nothing here moves anything:
//! the rollout executes only what passes the task's checks, whoever proposed it.

mod asking;
mod expert;
mod external;
mod judge;
mod onnx;
mod prompted;
mod proposing;
mod protocol;
mod random;
mod rehearsing;

pub use asking::Asking;
pub use expert::Expert;
pub use external::{External, Sight};
pub use onnx::Onnx;
pub use prompted::{
    FirstQuestion, MessagePart, Prompted, Rehearsed, StageMessage, conversation, first_questions,
    opening, rehearse,
};
pub use random::Random;
pub use rehearsing::Rehearsing;

pub use judge::Ground;

pub(crate) use expert::Aim;
pub(crate) use judge::is_accepted;

use crate::error::RunError;
use crate::outcome::Outcome;
use crate::pictures::Pictures;
use crate::record::{Asked, RehearsedStep, SentFiles};
use crate::result::StepResult;
use crate::scene::Scene;
use fab_base::interrupt::Interrupt;
use fab_model::calls::Fault;
use fab_model::{Description as ModelDescription, Lowering, ModelKind, Reply, Request};
use fab_picture::observation::Observation;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::reply::{Malformed, Stated};
use fab_program::verify::Verdict;
use fab_program::{Exhausted, Program, Proposal, Value};
use fab_world::Motion;
use fab_world::start::Start;
use image::RgbImage;
use serde::{Deserialize, Serialize};
use std::ops::Deref;
use std::path::Path;
use std::time::Duration;

/// Decides each step of one rollout.
pub trait Policy {
    /// Describes the policy for the run record; policies with different descriptions are different policies.
    fn description(&self) -> Description;

    /// Returns whether equal steps may get different decisions at another [`StepView::repetition`].
    ///
    /// A suite repeats the rollouts of such a policy, and runs those of others once.
    fn varies(&self) -> bool {
        true
    }

    /// Fails if this policy cannot do the task at all.
    fn prepare(&self, _program: &Program) -> Result<(), RunError> {
        Ok(())
    }

    /// Decides a step.
    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, RunError>;

    /// Returns whether its answers are tried on twins where the task rehearses: it is asked for further ones, by
    /// [`StepView::answer`] and [`Policy::revise`].
    fn rehearses(&self) -> bool {
        false
    }

    /// Revises an answer to the step that was decided last, given how the cloth would lie after it; `None` if it cannot.
    fn revise(
        &mut self,
        _step: &StepView<'_>,
        _exchange: &mut Exchange<'_, '_>,
        _predicted: &RgbImage,
    ) -> Result<Option<Decision>, RunError> {
        Ok(None)
    }
}

/// Makes the policy of one rollout; all policies that it makes are equal.
pub trait MakePolicy: Sync {
    /// Makes the policy; nothing is started or asked yet.
    fn make(&self) -> Box<dyn Policy + '_>;
}

/// A policy without memory is simply cloned.
impl<P: Policy + Clone + Sync> MakePolicy for P {
    fn make(&self) -> Box<dyn Policy + '_> {
        Box::new(self.clone())
    }
}

/// A policy's description in records and tables.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Description {
    /// What kind of policy it is.
    pub kind: Kind,
    /// Its name: that of the models, the seed's, or the command line.
    pub name: String,
    /// Whether it sees the true positions of the cloth's particles, which no camera shows.
    pub sees_particles: bool,
    /// The models that it asks, if any.
    pub models: Option<RoleModels>,
    /// SHA-256 of its code, if known.
    pub code: Option<String>,
}

/// The kind of a policy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Models that answer the task's prompts.
    Prompted,
    /// Draws from the declared action space.
    Random,
    /// Follows the task's demonstration.
    Expert,
    /// A network in an ONNX file.
    Network,
    /// A user's program.
    Program,
}

/// The models of a rollout, by role.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RoleModels {
    /// Answers stages that show pictures.
    pub vision: ModelDescription,
    /// Answers text-only stages.
    pub text: ModelDescription,
}

impl Description {
    /// Describes a policy that asks no model, sees what the camera shows, and is part of fabc.
    fn new(kind: Kind, name: String) -> Description {
        Description {
            kind,
            name,
            sees_particles: false,
            models: None,
            code: None,
        }
    }

    /// Returns whether a stand-in answers in place of a vision-language model.
    pub fn is_stand_in(&self) -> bool {
        let mut asked = self.models.iter().flat_map(|it| [&it.vision, &it.text]);
        asked.any(|model| model.nature == ModelKind::StandIn)
    }

    /// Returns the name, with the caveats that a reader of the figures must know.
    pub fn title(&self) -> String {
        let mut title = self.name.clone();
        if self.is_stand_in() {
            title += " (stand-in)";
        }
        if self.sees_particles {
            title += " (oracle: sees true particles)";
        }
        title
    }
}

/// The rollout's state at a step.
#[derive(Clone, Copy)]
pub struct StepView<'a> {
    /// What its actions are judged by.
    pub ground: Ground<'a>,
    /// The number of this action in the rollout, from 1; one step may take several.
    pub number: u32,
    /// The number of this step, from 1.
    pub step: u32,
    /// Which of several independent answers to the step is asked for or revised, from 0; only a policy that rehearses is
    /// asked for more than one.
    pub answer: u32,
    /// The most steps.
    pub horizon: u32,
    /// The result of the previous action, if it was for the same step.
    pub before: Option<StepResult>,
    /// The previous action.
    pub last: Option<&'a ExecutedAction>,
    /// What the world has done since the previous decision, if anything.
    pub executed: Option<&'a Motion>,
    /// The pictures that can be shown.
    pub pictures: &'a Pictures,
    /// Distinguishes runs that need independent answers.
    pub repetition: u32,
    /// Number of the start in its suite, if questions at other starts get answers of their own.
    pub start_number: Option<u64>,
    /// Digest of the start; empty outside a rollout.
    pub start: &'a str,
    /// The run folder; `None` outside a rollout.
    pub folder: Option<&'a Path>,
    /// What no camera shows; present only for a policy whose [`Description`] declares that it sees it.
    pub truth: Option<Truth<'a>>,
}

/// What only a simulator knows.
#[derive(Clone, Copy)]
pub struct Truth<'a> {
    /// The rollout's start.
    pub start: &'a Start,
    /// Every particle's position: `[dimy * dimx]`, index `iy * dimx + ix`, world frame, metres.
    pub particles: &'a [[f32; 3]],
}

impl<'a> Deref for StepView<'a> {
    type Target = Ground<'a>;

    fn deref(&self) -> &Ground<'a> {
        &self.ground
    }
}

impl<'a> StepView<'a> {
    /// Makes the view of a step outside any rollout: everything is in reach, and no motion is refused.
    pub fn without_rollout(
        program: &'a Program,
        scene: &'a Scene,
        observation: &'a Observation,
        step: u32,
        last: Option<&'a ExecutedAction>,
        pictures: &'a Pictures,
    ) -> StepView<'a> {
        StepView {
            ground: Ground::of(program, scene, observation),
            number: step,
            step,
            answer: 0,
            horizon: program.horizon,
            before: None,
            last,
            executed: None,
            pictures,
            repetition: 0,
            start_number: None,
            start: "",
            folder: None,
            truth: None,
        }
    }

    /// Returns the facts of the step, with points as whole pixels of the camera's picture.
    fn facts(self) -> Facts<'a> {
        let pointing = Lowering::PIXELS.pointing(self.pictures.size());
        Facts {
            last: self.last,
            ..Facts::of(self.scene, self.step, pointing)
        }
    }

    /// Decides about a step without an answer: only faults of the policy are ever skipped.
    fn without_answer(&self, outcome: Outcome) -> Decision {
        let why = match outcome {
            Outcome::Interrupted => "it was interrupted before it had decided",
            _ => "no answer could be executed; the attempts say why",
        };
        let why = why.to_owned();
        let stop = Decision::Stop { outcome, why };
        if self.program.verify.exhausted == Exhausted::Skips && stop.is_exhausted() {
            return Decision::Skip(outcome);
        }
        stop
    }
}

/// What a policy may use while it decides.
pub struct Exchange<'e, 'j> {
    /// Gets answers, which are bought or computed once and never again.
    pub asking: &'e mut Asking<'j>,
    /// Receives each question before it is asked, and each attempt as soon as it is complete. Returns the files of a
    /// question, and nothing else.
    pub record: &'e mut dyn FnMut(Exchanged<'_>) -> Result<SentFiles, RunError>,
    /// A request to stop early.
    pub interrupt: &'e Interrupt,
}

/// What a policy tells while it decides.
#[derive(Clone, Debug)]
pub enum Exchanged<'a> {
    /// A question that is about to be asked.
    Question {
        /// The stage that asks.
        stage: &'a str,
        /// The attempt's number within this stage and step, from 1.
        attempt: u32,
        /// The question.
        question: &'a Question,
    },
    /// A complete attempt.
    Attempt(&'a Attempt),
    /// What was tried on twins in the step, and how long it took.
    Rehearsed(&'a RehearsedStep, Duration),
    /// Something that the user should know.
    Note(String),
}

/// One proposal or answer, and its result.
#[derive(Clone, Debug)]
pub struct Attempt {
    /// Its entry in the record, before its reply has a file.
    pub asked: Asked,
    /// The reply, if there was one.
    pub reply: Option<Reply>,
    /// How long the answer took.
    pub took: Duration,
}

/// The question behind an answer.
#[derive(Clone, Debug)]
pub enum Question {
    /// A model's prompt.
    Prompt(Box<Request>),
    /// A line to a program.
    Line {
        /// Identical for equal questions.
        key: String,
        /// The line as sent.
        text: String,
    },
}

impl Question {
    /// Returns the key that equal questions share.
    pub fn key(&self) -> String {
        match self {
            Question::Prompt(request) => request.key(),
            Question::Line { key, .. } => key.clone(),
        }
    }
}

/// The meaning of an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "finding", rename_all = "snake_case")]
pub enum Finding {
    /// A text for later stages.
    Text {
        /// The variable it fills.
        name: String,
        /// The text.
        value: String,
        /// Where the answer states it, and the repairs needed to read it.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        stated: Vec<Stated>,
    },
    /// An action, and whether it may run.
    Action {
        /// Its fields.
        fields: Vec<(String, Value)>,
        /// Where the answer states each field, and the repairs needed to read it; empty if no model answered.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        stated: Vec<Stated>,
        /// The verifier's answer.
        verdict: Verdict,
    },
    /// The answer could not be read.
    Malformed(Malformed),
    /// There was no answer.
    Failed {
        /// How the rollout ends.
        outcome: Outcome,
        /// The fault of the last call, if one was made.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fault: Option<Fault>,
        /// Why.
        why: String,
    },
}

/// What to do in a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Decision {
    /// Execute this.
    Act {
        /// The action of each gripper; current worlds have one.
        grips: Vec<Proposal>,
        /// The answer that was taken.
        accepted: Accepted,
    },
    /// Do nothing in this step, and go on; without skipping, the rollout would have ended with this outcome.
    Skip(Outcome),
    /// End the rollout.
    Stop {
        /// How it ends.
        outcome: Outcome,
        /// Why, in words.
        why: String,
    },
}

impl Decision {
    /// Executes an action with the only gripper.
    fn act(proposal: Proposal, accepted: Accepted) -> Decision {
        Decision::Act {
            grips: vec![proposal],
            accepted,
        }
    }

    /// Returns whether a person stopped it.
    fn is_interrupted(&self) -> bool {
        let interrupted = Outcome::Interrupted;
        matches!(self, Decision::Stop { outcome, .. } if *outcome == interrupted)
    }

    /// Returns whether every permitted answer was refused or unreadable.
    fn is_exhausted(&self) -> bool {
        let (Decision::Skip(outcome) | Decision::Stop { outcome, .. }) = self else {
            return false;
        };
        matches!(
            outcome,
            Outcome::AttemptsExhausted | Outcome::MalformedReply
        )
    }
}

/// The answer that was taken in the end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accepted {
    /// The stage that asked for it.
    pub stage: String,
    /// The number of its question within that stage and step, from 1.
    pub attempt: u32,
    /// The checks that were dropped after all questions were used up; empty if it passes every check.
    pub without: Vec<String>,
}
