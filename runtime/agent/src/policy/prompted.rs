//! The policy that asks models, as the task's stages say, and after a refusal asks again with the reason.
//!
//! In: the stages, the step's pictures, the models. Out: every attempt as it happens, and a [`Decision`]. The program's
//! `attempts` limit the number of questions per stage.

mod conversation;
mod dialogue;
mod rehearsal;

use super::proposing::{Refusal, Settled};
use super::{Again, Decision, Description, Exchange, Kind, Policy, RoleModels, RunError, StepView};
use crate::outcome::Outcome;
pub use conversation::{MessagePart, StageMessage, conversation, opening};
use dialogue::{Dialogue, Setting};
use fab_model::{Description as ModelDescription, Models, Png, lowering};
use fab_picture::png;
use fab_program::render::{RenderError, Values};
use fab_program::{Program, Read};
pub use rehearsal::{Rehearsed, rehearse};
use std::collections::BTreeMap;

/// What the model is told with the picture of what would come of its answer.
const PREDICTED: &str = "The picture shows how the cloth would lie after this action, as a simulation predicts it. Answer once more, in the same format: with the same action if the cloth would lie as it should, otherwise with a better one.";

/// A policy that asks models.
#[derive(Clone)]
pub struct Prompted<'m> {
    /// Which model answers which role.
    pub models: Models<'m>,
    /// The texts that the current step's stages read.
    texts: BTreeMap<String, String>,
    /// The index of the stage that reads the action, and its conversations in the current step, one for each answer.
    acting: (usize, Vec<Dialogue>),
}

impl<'m> Prompted<'m> {
    /// Makes the policy of models.
    pub fn new(models: Models<'m>) -> Prompted<'m> {
        Prompted {
            models,
            texts: BTreeMap::new(),
            acting: (0, Vec::new()),
        }
    }

    fn setting<'a>(&'a self, step: &StepView<'a>, stage: usize) -> Setting<'a> {
        let stage = &step.program.stages[stage];
        Setting {
            view: *step,
            stage,
            texts: &self.texts,
            model: self.models.of(stage.model),
        }
    }
}

impl Policy for Prompted<'_> {
    fn description(&self) -> Description {
        Description {
            models: Some(RoleModels {
                vision: ModelDescription::of(self.models.vision),
                text: ModelDescription::of(self.models.text),
            }),
            ..Description::new(Kind::Prompted, self.models.name())
        }
    }

    fn varies(&self) -> bool {
        self.models.varies()
    }

    fn prepare(&self, program: &Program) -> Result<(), RunError> {
        Ok(lowering::check(program, self.models).map_err(RenderError::from)?)
    }

    fn rehearses(&self) -> bool {
        true
    }

    /// Asks every stage of one step and returns the decision.
    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, RunError> {
        self.texts.clear();
        self.acting.1.clear();
        let mut decision = step.without_answer(Outcome::MalformedReply);
        for (index, stage) in step.program.stages.iter().enumerate() {
            let at = self.setting(step, index);
            let mut dialogue = Dialogue::begin(at, Values::Known, [0, 0])?;
            let settled = dialogue.settle(at, step.program.verify.attempts, exchange)?;
            if stage.read == Read::Action {
                self.acting = (index, vec![dialogue]);
            }
            match settled {
                Settled::Text { name, value } => {
                    self.texts.insert(name, value);
                }
                Settled::Action(proposal, accepted) => decision = Decision::act(proposal, accepted),
                Settled::Failed { outcome, .. } => return Ok(step.without_answer(outcome)),
                Settled::Refused(last) => return Ok(step.without_answer(exhausted(last))),
            }
        }
        Ok(decision)
    }

    fn again(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
        again: Again<'_>,
    ) -> Result<Option<Decision>, RunError> {
        // An earlier stage may have had no answer, so that nothing was acted on.
        if self.acting.1.is_empty() {
            return Ok(None);
        }
        let (stage, mut dialogues) = std::mem::take(&mut self.acting);
        let at = self.setting(step, stage);
        let asked = dialogues
            .iter()
            .map(|dialogue| dialogue.asked)
            .max()
            .unwrap_or(0);
        let settled = match again {
            Again::Independent => {
                let numbers = [dialogues.len() as u32, asked];
                let mut dialogue = Dialogue::begin(at, Values::Known, numbers)?;
                let settled = dialogue.settle(at, step.program.verify.attempts, exchange)?;
                dialogues.push(dialogue);
                settled
            }
            Again::Revised { answer, predicted } => {
                let Some(dialogue) = dialogues.get_mut(answer) else {
                    return Ok(None);
                };
                let sent = at.model.lowering().resized(predicted).into_owned();
                dialogue.show_prediction(PREDICTED, Png::new(png::encode(&sent)));
                dialogue.asked = asked;
                dialogue.settle(at, 1, exchange)?
            }
        };
        self.acting = (stage, dialogues);
        Ok(Some(match settled {
            Settled::Action(proposal, accepted) => Decision::act(proposal, accepted),
            Settled::Failed {
                outcome: outcome @ Outcome::Interrupted,
                ..
            } => step.without_answer(outcome),
            Settled::Failed { outcome, why } => Decision::Stop { outcome, why },
            Settled::Refused(last) => step.without_answer(exhausted(last)),
            Settled::Text { .. } => return Ok(None),
        }))
    }
}

/// Returns how a step ends whose last answer was refused, or could not be read.
fn exhausted(last: Option<Refusal>) -> Outcome {
    if last.is_some_and(|refusal| refusal.proposal.is_some()) {
        Outcome::AttemptsExhausted
    } else {
        Outcome::MalformedReply
    }
}
