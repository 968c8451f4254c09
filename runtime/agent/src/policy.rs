//! Who decides what is done in a step, behind one trait.
//!
//! In: a [`StepView`], what a rollout knows at a step. Out: a [`Decision`]: grips to carry out, or why there are none.
//! [`Prompted`] asks models, as the task's stages say; [`Random`] draws from what is offered; [`Expert`] follows the
//! task's own demonstration; [`External`] is a program of the user's. Nothing here moves anything: the rollout carries
//! out only what passes the task's checks, whoever proposed it.

mod asking;
mod expert;
mod external;
mod judge;
mod prompted;
mod proposing;
mod random;
mod reach;

pub use asking::{Asking, Step};
pub use expert::Expert;
pub use external::{External, Sight};
pub use prompted::{
    Conversation, PromptError, Prompted, Rehearsed, Spoken, SpokenPart, conversation, opening,
    rehearse,
};
pub use random::Random;

pub(crate) use judge::is_accepted;

use crate::demos::DemosError;
use crate::journal::JournalError;
use crate::outcome::Outcome;
use crate::pictures::Pictures;
use crate::result::StepResult;
use crate::scene::Scene;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{CallRefused, Fault};
use fab_model::{Description as ModelDescription, Lowering, Nature, Reply, Request};
use fab_picture::observation::Observation;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::Pointing;
use fab_program::render::RenderError;
use fab_program::verify::Verdict;
use fab_program::{Exhausted, Program, Proposal, Value};
use fab_world::Reach;
use fab_world::start::Start;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// Decides what is done in each step of one rollout.
pub trait Policy {
    /// Says who decides, as the run record keeps it; two that differ in it are not the same.
    fn description(&self) -> Description;

    /// Returns whether equal steps may be decided otherwise at another [`StepView::repetition`].
    ///
    /// A suite repeats the rollouts of such a policy, and runs others once.
    fn varies(&self) -> bool {
        true
    }

    /// Returns what is worth knowing before the first step.
    ///
    /// Fails where this policy cannot do the task at all.
    fn prepare(&self, _program: &Program) -> Result<Option<String>, PolicyError> {
        Ok(None)
    }

    /// Decides a step.
    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, PolicyError>;
}

/// Makes the policy of one rollout; all that it makes are equal.
pub trait MakePolicy: Sync {
    /// Makes it; nothing is started or asked yet.
    fn make(&self) -> Box<dyn Policy + '_>;
}

/// A policy that remembers nothing makes copies of itself.
impl<P: Policy + Clone + Sync> MakePolicy for P {
    fn make(&self) -> Box<dyn Policy + '_> {
        Box::new(self.clone())
    }
}

/// Who decides, as records and tables name it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Description {
    /// What kind of policy it is.
    pub kind: Kind,
    /// Its name: that of the models, the seed's, or the command line.
    pub name: String,
    /// Whether it looks at the true places of the cloth's particles, which no camera shows.
    pub sees_particles: bool,
    /// The models that it asks, where it asks any.
    pub models: Option<RoleModels>,
    /// SHA-256 of what it is made of, where that is known.
    pub code: Option<String>,
}

/// What kind of policy decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Models that answer the task's prompts.
    Prompted,
    /// Draws from the declared action space.
    Random,
    /// Follows the task's demonstration.
    Expert,
    /// A program of the user's.
    Program,
}

/// The models of a rollout, by role.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RoleModels {
    /// Answers stages that show pictures.
    pub vision: ModelDescription,
    /// Answers stages of words alone.
    pub text: ModelDescription,
}

impl Description {
    /// Returns whether a stand-in answers in place of a vision-language model.
    pub fn is_stand_in(&self) -> bool {
        let models = self.models.iter();
        let mut natures = models.flat_map(|models| [models.vision.nature, models.text.nature]);
        natures.any(|nature| nature == Nature::StandIn)
    }

    /// Returns the name with what a reader of a figure must know beside it.
    pub fn title(&self) -> String {
        let stand_in = if self.is_stand_in() {
            " (stand-in)"
        } else {
            ""
        };
        let sight = match self.sees_particles {
            true => " (sees true particles)",
            false => "",
        };
        format!("{}{stand_in}{sight}", self.name)
    }
}

/// What a rollout knows at a step.
#[derive(Clone, Copy)]
pub struct StepView<'a> {
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
    /// The most steps.
    pub horizon: u32,
    /// What the action before came to, where it was for the same step.
    pub before: Option<StepResult>,
    /// The action before.
    pub last: Option<&'a ExecutedAction>,
    /// What can be shown.
    pub pictures: &'a Pictures,
    /// What is out of reach of the world that is to act.
    pub reach: &'a Reach<'a>,
    /// Tells apart runs that want independent answers.
    pub repetition: u32,
    /// Digest of the start; empty outside of a rollout.
    pub start: &'a str,
    /// The run folder; none outside of a rollout.
    pub folder: Option<&'a Path>,
    /// What no camera shows: there only for a policy whose [`Description`] says that it looks at it.
    pub truth: Option<Truth<'a>>,
}

/// What only a simulator knows.
#[derive(Clone, Copy)]
pub struct Truth<'a> {
    /// Where the cloth lay at first.
    pub start: &'a Start,
    /// Every particle's place: `[dimy * dimx]`, index `iy * dimx + ix`, world frame, metres.
    pub particles: &'a [[f32; 3]],
}

impl<'a> StepView<'a> {
    /// Looks at a step outside of any rollout: everything is in reach.
    pub fn outside(
        program: &'a Program,
        scene: &'a Scene,
        observation: &'a Observation,
        step: u32,
        last: Option<&'a ExecutedAction>,
        pictures: &'a Pictures,
    ) -> StepView<'a> {
        StepView {
            program,
            scene,
            observation,
            number: step,
            step,
            horizon: program.horizon,
            before: None,
            last,
            pictures,
            reach: &fab_world::everywhere,
            repetition: 0,
            start: "",
            folder: None,
            truth: None,
        }
    }

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

    /// Returns how points are written as whole pixels of the camera's picture.
    fn pixels(&self) -> Pointing {
        Lowering::PIXELS.pointing(self.pictures.size())
    }

    /// Returns what becomes of a step without an answer: only what a policy can do wrong is ever skipped.
    fn without_answer(&self, outcome: Outcome) -> Decision {
        match (self.program.verify.exhausted, outcome) {
            (Exhausted::Skips, Outcome::AttemptsExhausted | Outcome::MalformedReply) => {
                Decision::Skip(outcome)
            }
            _ => Decision::Stop {
                outcome,
                why: "no answer could be executed; the attempts say why".to_owned(),
            },
        }
    }
}

/// What a policy may use while it decides.
pub struct Exchange<'e, 'j> {
    /// Answers that are bought or computed once, and never again.
    pub asking: &'e mut Asking<'j>,
    /// Gets each attempt as soon as it is complete.
    pub record: &'e mut dyn FnMut(&Attempt) -> Result<(), JournalError>,
    /// A request to stop early.
    pub interrupt: &'e Interrupt,
}

/// One proposal or answer, and what came of it.
#[derive(Clone, Debug)]
pub struct Attempt {
    /// The stage that asked; `policy` where the policy has no stages.
    pub stage: String,
    /// Which one of this stage and step it was, from 1.
    pub number: u32,
    /// What was asked, where somebody was.
    pub question: Option<Question>,
    /// What came back, where something did.
    pub reply: Option<Reply>,
    /// What the policy says of it, for people.
    pub note: Option<String>,
    /// What it meant.
    pub finding: Finding,
    /// How long the answer took.
    pub took: Duration,
}

/// What was asked for an answer.
#[derive(Clone, Debug)]
pub enum Question {
    /// A model's prompt.
    Prompt(Box<Request>),
    /// A line to a program.
    Line {
        /// The same for equal questions.
        key: String,
        /// As it was sent.
        text: String,
    },
}

impl Question {
    /// Returns what equal questions share.
    pub fn key(&self) -> String {
        match self {
            Question::Prompt(request) => request.key(),
            Question::Line { key, .. } => key.clone(),
        }
    }
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
        /// What each gripper does; today's worlds have one.
        grips: Vec<Proposal>,
        /// Which answer it is.
        accepted: Accepted,
    },
    /// Do nothing in this step, and go on; the rollout would have ended so.
    Skip(Outcome),
    /// End the rollout.
    Stop {
        /// How it ends.
        outcome: Outcome,
        /// Why, in words.
        why: String,
    },
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

/// Why a step could not be decided.
#[derive(Debug, thiserror::Error)]
pub enum PolicyError {
    /// The policy cannot do this task in this world.
    #[error("{0}")]
    Unfit(String),
    /// A template and its values do not fit; only a program edited by hand can do that.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The demonstrations cannot be told.
    #[error(transparent)]
    Demos(#[from] DemosError),
    /// An answer could not be kept, or is lost: nothing further may be asked.
    #[error(transparent)]
    Calls(CallRefused),
    /// The run folder cannot be written.
    #[error(transparent)]
    Record(#[from] JournalError),
}

impl From<PromptError> for PolicyError {
    fn from(error: PromptError) -> Self {
        match error {
            PromptError::Render(error) => PolicyError::Render(error),
            PromptError::Demos(error) => PolicyError::Demos(error),
        }
    }
}
