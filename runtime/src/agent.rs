//! Decides one step: asks, reads, judges, and asks again with the reason of the refusal.
//!
//! In: the program, the scene, the step's pictures, the models. Out: every attempt as it happens, and
//! a [`Decision`]. The number of questions is bounded by the program's `attempts` per stage. Nothing
//! here moves anything.

use crate::model::{Message, Model, ModelRole, Part, Png, Reply, Request, Speaker};
use crate::outcome::Outcome;
use crate::scene::Scene;
use crate::subgoals::StepPictures;
use compiler::program::{Picture, Program, Read, Stage};
use compiler::render::{self, Bindings, PromptSpeaker, RenderError};
use compiler::reply::{self, Malformed, Proposal, Reading};
use compiler::verify::{self, Verdict};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Which model answers which role.
#[derive(Clone, Copy)]
pub struct Models<'a> {
    /// Answers stages that show pictures.
    pub vision: &'a dyn Model,
    /// Answers stages of words alone.
    pub text: &'a dyn Model,
}

impl<'a> Models<'a> {
    /// Returns the model for a role.
    pub fn of(&self, role: ModelRole) -> &'a dyn Model {
        match role {
            ModelRole::Vision => self.vision,
            ModelRole::Text => self.text,
        }
    }
}

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
#[derive(Clone, Debug, PartialEq, Serialize)]
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
        /// Its fields, in pixels.
        fields: Vec<(String, compiler::program::PixelPoint)>,
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
        /// Why.
        why: String,
    },
}

/// What is to be done in a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Decision {
    /// Execute this.
    Act(Proposal),
    /// End the rollout so.
    Stop(Outcome),
}

/// Why a step could not even be asked.
#[derive(Debug, thiserror::Error)]
pub enum AgentError<E> {
    /// A template and its values do not fit; only a program edited by hand can do that.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The caller could not keep an attempt.
    #[error(transparent)]
    Record(E),
}

/// Asks every stage of one step and returns what to do.
///
/// `record` gets each attempt as soon as it is complete; where it fails, the step ends with its error.
pub fn decide<E: std::error::Error>(
    program: &Program,
    scene: &Scene,
    pictures: &StepPictures,
    models: Models<'_>,
    record: &mut dyn FnMut(&Attempt) -> Result<(), E>,
) -> Result<Decision, AgentError<E>> {
    let mut bindings = scene.bindings();
    let mut decision = Decision::Stop(Outcome::MalformedReply);
    for stage in &program.stages {
        let mut talk = Talk::begin(program, stage, pictures, &bindings)?;
        let answer = loop {
            let attempt = talk.ask(program, scene, models.of(stage.model), &bindings)?;
            record(&attempt).map_err(AgentError::Record)?;
            match talk.conclude(attempt, program.verify.attempts) {
                Next::AskAgain => {}
                Next::Done(answer) => break answer,
            }
        };
        match answer {
            Answer::Text { name, value } => bindings.text(&name, &value),
            Answer::Action(proposal) => decision = Decision::Act(proposal),
            Answer::None(outcome) => return Ok(Decision::Stop(outcome)),
        }
    }
    Ok(decision)
}

/// What a stage comes to in the end.
enum Answer {
    Text { name: String, value: String },
    Action(Proposal),
    None(Outcome),
}

enum Next {
    AskAgain,
    Done(Answer),
}

/// The conversation of one stage in one step.
struct Talk<'a> {
    stage: &'a Stage,
    messages: Vec<Message>,
    asked: u32,
}

impl<'a> Talk<'a> {
    fn begin(
        program: &Program,
        stage: &'a Stage,
        pictures: &StepPictures,
        bindings: &Bindings,
    ) -> Result<Self, RenderError> {
        Ok(Talk {
            stage,
            messages: conversation(program, stage, bindings, |picture| pictures.png(picture))?,
            asked: 0,
        })
    }

    fn ask<E>(
        &mut self,
        program: &Program,
        scene: &Scene,
        model: &dyn Model,
        bindings: &Bindings,
    ) -> Result<Attempt, AgentError<E>> {
        self.asked += 1;
        let request = Request {
            role: self.stage.model,
            messages: self.messages.clone(),
            temperature: self.stage.temperature,
            max_tokens: self.stage.max_tokens,
            repetition: 0,
        };
        let begun = Instant::now();
        let answered = model.ask(&request);
        let took = begun.elapsed();
        let (reply, finding) = match answered {
            Ok(reply) => {
                let finding = judge(program, self.stage, scene, bindings, &reply.text)?;
                (Some(reply), finding)
            }
            Err(error) => (
                None,
                Finding::Failed {
                    why: error.to_string(),
                },
            ),
        };
        Ok(Attempt {
            stage: self.stage.name.clone(),
            number: self.asked,
            request,
            reply,
            finding,
            took,
        })
    }

    fn conclude(&mut self, attempt: Attempt, attempts: u32) -> Next {
        let (correction, outcome) = match attempt.finding {
            Finding::Text { name, value, .. } => return Next::Done(Answer::Text { name, value }),
            Finding::Action {
                fields,
                verdict: Verdict::Accept,
                ..
            } => return Next::Done(Answer::Action(Proposal { fields })),
            Finding::Failed { .. } => return Next::Done(Answer::None(Outcome::ModelFailed)),
            Finding::Action {
                verdict: Verdict::Reject { message, .. },
                ..
            } => (message, Outcome::AttemptsExhausted),
            Finding::Malformed { message, .. } => (message, Outcome::MalformedReply),
        };
        if self.asked >= attempts {
            return Next::Done(Answer::None(outcome));
        }
        let said = attempt.reply.map(|reply| reply.text).unwrap_or_default();
        self.messages.push(Message::text(Speaker::Assistant, said));
        self.messages.push(Message::text(Speaker::User, correction));
        Next::AskAgain
    }
}

/// Renders the opening messages of a stage; `fabc render` shows what this returns.
///
/// `png` gives the encoded picture for each picture of the prompt, in order.
pub fn conversation(
    program: &Program,
    stage: &Stage,
    bindings: &Bindings,
    png: impl Fn(Picture) -> Png,
) -> Result<Vec<Message>, RenderError> {
    let prompts = render::messages(program, stage, bindings)?;
    let message = |prompt: render::PromptMessage| {
        let speaker = match prompt.speaker {
            PromptSpeaker::System => Speaker::System,
            PromptSpeaker::User => Speaker::User,
        };
        let mut parts = vec![Part::Text(prompt.text)];
        parts.extend(
            prompt
                .pictures
                .into_iter()
                .map(|picture| Part::Image(png(picture))),
        );
        Message { speaker, parts }
    };
    Ok(prompts.into_iter().map(message).collect())
}

/// Reads an answer and, where it proposes an action, lets the verifier judge it.
fn judge(
    program: &Program,
    stage: &Stage,
    scene: &Scene,
    bindings: &Bindings,
    text: &str,
) -> Result<Finding, RenderError> {
    let malformed = |Malformed { field, message }| Finding::Malformed { field, message };
    match &stage.read {
        Read::Text {
            name,
            before,
            after,
        } => Ok(match reply::read_text(before, after, text) {
            Ok(Reading { value, repairs }) => Finding::Text {
                name: name.clone(),
                value,
                repairs,
            },
            Err(error) => malformed(error),
        }),
        Read::Action => match reply::read_action(program, text) {
            Ok(Reading { value, repairs }) => {
                let verdict = verify::verdict(program, scene, &value, bindings)?;
                Ok(Finding::Action {
                    fields: value.fields,
                    repairs,
                    verdict,
                })
            }
            Err(error) => Ok(malformed(error)),
        },
    }
}
