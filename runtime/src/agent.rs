//! Decides one step: asks, reads, judges, and asks again with the reason of the refusal.
//!
//! In: the program, the scene, the step's pictures, the models. Out: every attempt as it happens, and
//! a [`Decision`]. The number of questions is bounded by the program's `attempts` per stage. Nothing
//! here moves anything.

use crate::examples::Told;
use crate::model::{Message, Model, ModelRole, Part, Png, Reply, Request, Speaker};
use crate::outcome::Outcome;
use crate::pictures::Pictures;
use crate::scene::Scene;
use compiler::facts::{Done, Facts};
use compiler::program::{Program, Read, Stage, Value};
use compiler::render::{self, PromptPicture, PromptSpeaker, RenderError, Values};
use compiler::reply::{self, Malformed, Proposal, Reading};
use compiler::verify::{self, Strictness, Verdict};
use serde::Serialize;
use std::collections::BTreeMap;
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
    /// End the rollout so.
    Stop(Outcome),
}

/// Which answer was taken in the end.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    /// Which step this is, from 1.
    pub step: u32,
    /// The action before.
    pub last: Option<&'a Done>,
    /// What can be shown.
    pub pictures: &'a Pictures,
}

impl<'a> Situation<'a> {
    fn facts(self, texts: &'a BTreeMap<String, String>) -> Facts<'a> {
        Facts {
            scene: self.scene,
            texts,
            step: self.step,
            last: self.last,
            proposal: None,
        }
    }
}

/// Asks every stage of one step and returns what to do.
///
/// `record` gets each attempt as soon as it is complete; where it fails, the step ends with its error.
pub fn decide<E: std::error::Error>(
    situation: Situation<'_>,
    models: Models<'_>,
    record: &mut dyn FnMut(&Attempt) -> Result<(), E>,
) -> Result<Decision, AgentError<E>> {
    let program = situation.program;
    let mut texts = BTreeMap::new();
    let mut decision = Decision::Stop(Outcome::MalformedReply);
    for stage in &program.stages {
        let mut talk = Talk::begin(situation, stage, &texts)?;
        let answer = loop {
            let attempt = talk.ask(models.of(stage.model), &texts)?;
            record(&attempt).map_err(AgentError::Record)?;
            match talk.conclude(attempt, &texts)? {
                Next::AskAgain => {}
                Next::Done(answer) => break answer,
            }
        };
        match answer {
            Answer::Text { name, value } => {
                texts.insert(name, value);
            }
            Answer::Action { proposal, accepted } => {
                decision = Decision::Act { proposal, accepted };
            }
            Answer::None(outcome) => return Ok(Decision::Stop(outcome)),
        }
    }
    Ok(decision)
}

/// What a stage comes to in the end.
enum Answer {
    Text {
        name: String,
        value: String,
    },
    Action {
        proposal: Proposal,
        accepted: Accepted,
    },
    None(Outcome),
}

enum Next {
    AskAgain,
    Done(Answer),
}

/// The conversation of one stage in one step.
struct Talk<'a> {
    situation: Situation<'a>,
    stage: &'a Stage,
    messages: Vec<Message>,
    asked: u32,
    /// Actions that were read and refused, oldest first, each with its question's number.
    refused: Vec<(u32, Proposal)>,
}

impl<'a> Talk<'a> {
    fn begin(
        situation: Situation<'a>,
        stage: &'a Stage,
        texts: &BTreeMap<String, String>,
    ) -> Result<Self, RenderError> {
        let values = Values::Known(situation.facts(texts));
        let png = |picture: &PromptPicture| situation.pictures.png(picture);
        let told = situation
            .pictures
            .examples
            .told(&stage.name, situation.step);
        Ok(Talk {
            situation,
            stage,
            messages: conversation(situation.program, stage, values, told, png)?,
            asked: 0,
            refused: Vec::new(),
        })
    }

    fn ask<E>(
        &mut self,
        model: &dyn Model,
        texts: &BTreeMap<String, String>,
    ) -> Result<Attempt, AgentError<E>> {
        self.asked += 1;
        let request = Request {
            role: self.stage.model,
            messages: self.messages.clone(),
            temperature: self.stage.temperature,
            top_p: self.stage.top_p,
            max_tokens: self.stage.max_tokens,
            repetition: 0,
        };
        let begun = Instant::now();
        let answered = model.ask(&request);
        let took = begun.elapsed();
        let (reply, finding) = match answered {
            Ok(reply) => {
                let facts = self.situation.facts(texts);
                let finding = judge(self.situation.program, self.stage, facts, &reply.text)?;
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

    fn conclude(
        &mut self,
        attempt: Attempt,
        texts: &BTreeMap<String, String>,
    ) -> Result<Next, RenderError> {
        let (correction, outcome) = match attempt.finding {
            Finding::Text { name, value, .. } => {
                return Ok(Next::Done(Answer::Text { name, value }));
            }
            Finding::Action {
                fields,
                verdict: Verdict::Accept,
                ..
            } => {
                let proposal = Proposal { fields };
                return Ok(Next::Done(self.accept(proposal, attempt.number, &[])));
            }
            Finding::Failed { .. } => return Ok(Next::Done(Answer::None(Outcome::ModelFailed))),
            Finding::Action {
                fields,
                verdict: Verdict::Reject { message, .. },
                ..
            } => {
                self.refused.push((attempt.number, Proposal { fields }));
                (message, Outcome::AttemptsExhausted)
            }
            Finding::Malformed { message, .. } => (message, Outcome::MalformedReply),
        };
        if self.asked >= self.situation.program.verify.attempts {
            let relaxed = self.relaxed(texts)?;
            return Ok(Next::Done(relaxed.unwrap_or(Answer::None(outcome))));
        }
        let said = attempt.reply.map(|reply| reply.text).unwrap_or_default();
        self.messages.push(Message::text(Speaker::Assistant, said));
        self.messages.push(Message::text(Speaker::User, correction));
        Ok(Next::AskAgain)
    }

    /// Judges the answers in hand once more, newest first, without the checks that the task then leaves out.
    fn relaxed(&self, texts: &BTreeMap<String, String>) -> Result<Option<Answer>, RenderError> {
        let program = self.situation.program;
        let without = &program.verify.relaxed;
        for (number, proposal) in self.refused.iter().rev().filter(|_| !without.is_empty()) {
            let facts = self.situation.facts(texts);
            let verdict = verify::verdict(program, facts, proposal, Strictness::Relaxed)?;
            if verdict == Verdict::Accept {
                return Ok(Some(self.accept(proposal.clone(), *number, without)));
            }
        }
        Ok(None)
    }

    fn accept(&self, proposal: Proposal, attempt: u32, without: &[String]) -> Answer {
        let accepted = Accepted {
            stage: self.stage.name.clone(),
            attempt,
            without: without.to_owned(),
        };
        Answer::Action { proposal, accepted }
    }
}

/// Renders the opening messages of a stage; `fabc render` shows what this returns.
///
/// - `told`: demonstrations, which stand just before the question.
/// - `png` gives the encoded picture for each picture of the prompt, in order.
pub fn conversation(
    program: &Program,
    stage: &Stage,
    values: Values<'_>,
    told: &[Told],
    png: impl Fn(&PromptPicture) -> Option<Png>,
) -> Result<Vec<Message>, RenderError> {
    let mut messages = Vec::new();
    for prompt in render::messages(program, stage, values)? {
        let speaker = match prompt.speaker {
            PromptSpeaker::System => Speaker::System,
            PromptSpeaker::User => Speaker::User,
            PromptSpeaker::Assistant => Speaker::Assistant,
        };
        let mut parts = vec![Part::Text(prompt.text)];
        for picture in &prompt.pictures {
            let found = png(picture).ok_or_else(|| RenderError::MissingFact {
                name: format!("{picture:?}"),
            })?;
            parts.push(Part::Image(found));
        }
        messages.push(Message { speaker, parts });
    }
    let question = messages.len().saturating_sub(1);
    let told = told.iter().flat_map(|Told { question, answer }| {
        [
            Message::text(Speaker::User, question),
            Message::text(Speaker::Assistant, answer),
        ]
    });
    messages.splice(question..question, told);
    Ok(messages)
}

/// Reads an answer and, where it proposes an action, lets the verifier judge it.
fn judge(
    program: &Program,
    stage: &Stage,
    facts: Facts<'_>,
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
                let verdict = verify::verdict(program, facts, &value, Strictness::Full)?;
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
