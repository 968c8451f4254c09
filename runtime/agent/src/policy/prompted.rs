//! The policy that asks models, as the task's stages say, and after a refusal asks again with the reason.
//!
//! In: the stages, the step's pictures, the models. Out: every attempt as it happens, and a [`Decision`]. The program's
//! `attempts` limit the number of questions per stage.

mod conversation;
mod dialogue;
mod rehearsal;

use super::proposing::{Refusal, Settled};
use super::{Decision, Description, Exchange, Kind, Policy, RoleModels, RunError, StepView};
use crate::outcome::Outcome;
pub use conversation::{MessagePart, StageMessage, conversation, opening};
use dialogue::{Answers, Dialogue, Setting};
use fab_model::{Description as ModelDescription, Models, Png, lowering};
use fab_picture::png;
use fab_program::render::{RenderError, Values};
use fab_program::{Program, Read, Stage};
use image::RgbImage;
pub use rehearsal::{FirstQuestion, Rehearsed, first_questions, rehearse};
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
    /// The conversations of the stage that reads the action in the current step, one for each answer.
    acting: Vec<Dialogue>,
}

impl<'m> Prompted<'m> {
    /// Makes the policy of models.
    pub fn new(models: Models<'m>) -> Prompted<'m> {
        Prompted {
            models,
            texts: BTreeMap::new(),
            acting: Vec::new(),
        }
    }

    fn setting<'a>(&'a self, step: &StepView<'a>, stage: &'a Stage) -> Setting<'a> {
        let model = self.models.of(stage.model);
        Setting {
            view: *step,
            stage,
            texts: &self.texts,
            lowering: model.lowering(),
            answers: Answers::Model(model),
        }
    }

    /// Returns how many questions the stage that reads the action has asked in this step.
    fn asked(&self) -> u32 {
        let asked = self.acting.iter().map(|dialogue| dialogue.asked);
        asked.max().unwrap_or(0)
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

    /// Asks every stage of one step and returns the decision; for a further answer, only the stage that reads the action.
    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, RunError> {
        if step.answer == 0 {
            self.texts.clear();
            self.acting.clear();
        } else if self.acting.is_empty() {
            // An earlier stage had no answer, so that nothing was acted on.
            return Ok(step.without_answer(Outcome::ModelFailed));
        }
        let mut decision = step.without_answer(Outcome::MalformedReply);
        for stage in &step.program.stages {
            let is_acting = stage.read == Read::Action;
            if step.answer > 0 && !is_acting {
                continue;
            }
            let at = self.setting(step, stage);
            let mut dialogue = Dialogue::begin(at, Values::Known, self.asked())?;
            let settled = dialogue.settle(at, step.program.verify.attempts, exchange)?;
            if is_acting {
                self.acting.push(dialogue);
            }
            match settled {
                Settled::Text { name, value } => {
                    self.texts.insert(name, value);
                }
                Settled::Action(proposal, accepted) => decision = Decision::act(proposal, accepted),
                settled => return Ok(decided(step, settled)),
            }
        }
        Ok(decision)
    }

    fn revise(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
        predicted: &RgbImage,
    ) -> Result<Option<Decision>, RunError> {
        let mut stages = step.program.stages.iter();
        let stage = stages.find(|stage| stage.read == Read::Action);
        let dialogue = self.acting.get(step.answer as usize).cloned();
        let (Some(stage), Some(mut dialogue)) = (stage, dialogue) else {
            return Ok(None);
        };
        let at = self.setting(step, stage);
        let sent = at.lowering.resized(predicted).into_owned();
        dialogue.show_prediction(PREDICTED, Png::new(png::encode(&sent)));
        dialogue.asked = self.asked();
        let settled = dialogue.settle(at, 1, exchange)?;
        self.acting[step.answer as usize] = dialogue;
        Ok(Some(decided(step, settled)))
    }
}

/// Returns what the stage that reads the action has come to.
fn decided(step: &StepView<'_>, settled: Settled) -> Decision {
    match settled {
        Settled::Action(proposal, accepted) => Decision::act(proposal, accepted),
        Settled::Failed { outcome, .. } => step.without_answer(outcome),
        Settled::Refused(Some(Refusal {
            proposal: Some(_), ..
        })) => step.without_answer(Outcome::AttemptsExhausted),
        Settled::Refused(_) | Settled::Text { .. } => step.without_answer(Outcome::MalformedReply),
    }
}
