//! The policy that asks models, as the task's stages say, and after a refusal asks again with the reason.
//!
//! In: the stages, the step's pictures, the models. Out: every attempt as it happens, and a [`Decision`]. The program's
//! `attempts` limit the number of questions per stage.

mod attempts;
mod candidates;
mod conversation;
mod rehearsal;

use super::{
    Decision, Description, Exchange, Finding, Kind, Policy, PolicyError, RoleModels, StepView,
};
use crate::outcome::Outcome;
use attempts::{Answer, Attempts, Missing, Next};
pub use conversation::{
    Conversation, MessagePart, PromptError, UndrawnMessage, conversation, opening,
};
use fab_model::{Description as ModelDescription, Model, Models, lowering};
use fab_program::render::RenderError;
use fab_program::{Program, Stage};
pub use rehearsal::{Rehearsed, rehearse};
use std::collections::BTreeMap;

/// A policy that asks models.
#[derive(Clone, Copy)]
pub struct Prompted<'m> {
    /// Which model answers which role.
    pub models: Models<'m>,
}

impl Policy for Prompted<'_> {
    fn description(&self) -> Description {
        Description {
            kind: Kind::Prompted,
            name: self.models.name(),
            sees_particles: false,
            models: Some(RoleModels {
                vision: ModelDescription::of(self.models.vision),
                text: ModelDescription::of(self.models.text),
            }),
            code: None,
        }
    }

    fn varies(&self) -> bool {
        self.models.varies()
    }

    fn prepare(&self, program: &Program) -> Result<Option<String>, PolicyError> {
        lowering::check(program, self.models).map_err(RenderError::from)?;
        Ok(lowering::note(program, self.models))
    }

    /// Asks every stage of one step and returns the decision.
    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, PolicyError> {
        let mut texts = BTreeMap::new();
        let mut decision = step.without_answer(Outcome::MalformedReply);
        for stage in &step.program.stages {
            let model = self.models.of(stage.model);
            let trusted = exchange.twins.as_ref();
            let trusted = trusted.is_some_and(|twins| twins.aside().is_none());
            let answer = match step.program.rehearsal_of(stage).filter(|_| trusted) {
                Some(how) => candidates::answer(*step, (stage, how), model, &texts, exchange)?,
                None => ask((*step, stage), model, &texts, exchange, (0, 0))?.answer,
            };
            match answer {
                Answer::Text { name, value } => {
                    texts.insert(name, value);
                }
                Answer::Action { proposal, accepted } => {
                    let grips = vec![proposal];
                    decision = Decision::Act { grips, accepted };
                }
                Answer::None(outcome) => return Ok(step.without_answer(outcome)),
            }
        }
        Ok(decision)
    }
}

/// The result of asking a stage.
struct Asked<'a> {
    answer: Answer,
    /// The conversation that led to it.
    attempts: Attempts<'a>,
    /// The text of the last reply; empty if none came.
    reply: String,
    /// Why the last question has no reply, if it has none.
    failed: Option<String>,
}

/// Asks a stage until it has its answer.
///
/// - `candidate`: which of several answers to one question is asked for, from 0, and how many questions of this stage
///   and step were asked before.
fn ask<'a>(
    (step, stage): (StepView<'a>, &'a Stage),
    model: &dyn Model,
    texts: &BTreeMap<String, String>,
    exchange: &mut Exchange<'_, '_>,
    (candidate, asked): (u32, u32),
) -> Result<Asked<'a>, PolicyError> {
    let lowering = model.lowering();
    let mut attempts = Attempts::begin(step, stage, texts, lowering, Missing::IsAnError)?;
    attempts.be_candidate(candidate, asked);
    loop {
        let attempt = attempts.ask(model, exchange, texts)?;
        let reply = attempt.reply.as_ref();
        let reply = reply.map(|it| it.text.clone()).unwrap_or_default();
        let failed = match &attempt.finding {
            Finding::Failed { why, .. } => Some(why.clone()),
            _ => None,
        };
        match attempts.conclude(attempt, texts)? {
            Next::AskAgain => {}
            Next::Done(answer) => {
                return Ok(Asked {
                    answer,
                    attempts,
                    reply,
                    failed,
                });
            }
        }
    }
}
