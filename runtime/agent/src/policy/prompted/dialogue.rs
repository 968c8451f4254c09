//! The conversation of one stage in one step: asks, and after a refusal asks again with the reason.

use super::{MessagePart, StageMessage, conversation};
use crate::action::Action;
use crate::outcome::Outcome;
use crate::pictures::scene_png;
use crate::policy::judge::judge;
use crate::policy::proposing::{Refusal, Settled, settle};
use crate::policy::{Attempt, Exchange, Exchanged, Finding, Question, RunError, StepView};
use crate::record::Asked;
use fab_model::calls::CallRefused;
use fab_model::{Lowering, Model, ModelError, Png, Reply, Request, Speaker};
use fab_program::facts::Facts;
use fab_program::pointing::Notation;
use fab_program::render::{self, PromptText, REFUSED_ACTION, RenderError, SEPARATOR, Values};
use fab_program::{Layers, ModelRole, OVERLAP, Picture, Proposal, Stage, reply, space};
use serde_json::Value;
use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::time::Instant;

/// Who is asked what: a stage in a step, with the texts that are known, and what answers.
#[derive(Clone, Copy)]
pub(super) struct Setting<'a> {
    pub view: StepView<'a>,
    pub stage: &'a Stage,
    pub texts: &'a BTreeMap<String, String>,
    pub lowering: Lowering,
    pub answers: Answers<'a>,
}

/// Where answers come from.
#[derive(Clone, Copy)]
pub(super) enum Answers<'a> {
    Model(&'a dyn Model),
    /// These in turn, and then none.
    Given(&'a RefCell<VecDeque<String>>),
}

impl<'a> Setting<'a> {
    fn facts(&self) -> Facts<'a> {
        let pointing = self.lowering.pointing(self.view.pictures.size());
        Facts {
            texts: self.texts,
            pointing,
            ..self.view.facts()
        }
    }
}

/// The conversation of one stage in one step. All its calls get the setting that it began with.
#[derive(Clone, Debug)]
pub(super) struct Dialogue {
    pub messages: Vec<StageMessage>,
    /// The notation of the scene's points for the model.
    notation: Notation,
    /// The schema of valid answers for this scene.
    schema: Value,
    /// The number of this stage's last question in the step, whichever conversation asked it.
    pub asked: u32,
    /// The last answer; empty if none came.
    answer: String,
}

impl Dialogue {
    /// Begins with the stage's messages.
    ///
    /// - `known`: [`Values::Known`], or [`Values::Partly`] to show missing texts as words in angle brackets.
    /// - `asked`: questions of this stage and step so far.
    pub fn begin<'a>(
        at: Setting<'a>,
        known: fn(Facts<'a>) -> Values<'a>,
        asked: u32,
    ) -> Result<Dialogue, RunError> {
        let (program, view, facts) = (at.view.program, at.view, at.facts());
        let (values, pictures, lowering) = (known(facts), view.pictures, &at.lowering);
        let mut messages = conversation(program, at.stage, values, pictures, view.step, lowering)?;
        if let (Some(remark), Some(question)) = (remark(view, facts)?, messages.last_mut()) {
            question.parts.push(MessagePart::Text(remark));
        }
        let notation = facts.notation(program);
        let fields = program.actions.iter();
        let offered: Vec<_> = fields
            .map(|field| (field.name.clone(), space::choices(field, view.scene)))
            .collect();
        Ok(Dialogue {
            messages,
            schema: reply::for_stage(program, at.stage, &notation, &offered),
            notation,
            asked,
            answer: String::new(),
        })
    }

    /// Asks at most so often, until the stage has its answer.
    pub fn settle(
        &mut self,
        at: Setting<'_>,
        attempts: u32,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Settled, RunError> {
        let mut ask = |refusals: &[Refusal], exchange: &mut Exchange<'_, '_>| {
            if let Some(refusal) = refusals.last() {
                self.correct(at, refusal)?;
            }
            self.ask(at, exchange)
        };
        settle(&at.view, attempts, at.facts(), exchange, &mut ask)
    }

    /// Adds the last answer, and what would come of it.
    pub fn show_prediction(&mut self, words: &str, predicted: Png) {
        self.say_answer(self.answer.clone());
        let words = PromptText::by_fabc(words.to_owned());
        let mut shown = StageMessage::text(Speaker::User, words);
        let what = "what would come of the answer";
        shown.parts.push(MessagePart::Added(what, predicted));
        self.messages.push(shown);
    }

    fn say_answer(&mut self, text: String) {
        let stretches = Vec::new();
        let answer = StageMessage::text(Speaker::Assistant, PromptText { text, stretches });
        self.messages.push(answer);
    }

    /// Returns the next question, as it is sent.
    pub fn request(&self, Setting { view, stage, .. }: Setting<'_>) -> Request {
        Request {
            role: stage.model,
            messages: self.messages.iter().map(StageMessage::sent).collect(),
            temperature: stage.temperature,
            top_p: stage.top_p,
            max_tokens: stage.max_tokens,
            reasoning: stage.reasoning,
            repetition: view.repetition,
            start: view.start_number,
            step: view.number,
            candidate: view.answer,
            schema: Some(self.schema.clone()),
        }
    }

    /// Asks the next question, and judges the answer.
    fn ask(
        &mut self,
        at: Setting<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Attempt, RunError> {
        let Setting { view, stage, .. } = at;
        self.asked += 1;
        let request = self.request(at);
        let question = Question::Prompt(Box::new(request.clone()));
        let sent = (exchange.record)(Exchanged::Question {
            stage: &stage.name,
            attempt: self.asked,
            question: &question,
        })?;
        let begun = Instant::now();
        let answered = match at.answers {
            Answers::Model(model) => exchange.asking.ask(model, &request),
            Answers::Given(answers) => {
                let answer = answers.borrow_mut().pop_front();
                answer
                    .map(Reply::text)
                    .ok_or(CallRefused::Interrupted.into())
            }
        };
        let took = begun.elapsed();
        let (reply, finding) = match answered {
            Ok(reply) => {
                let finding = judge(view, stage, at.facts(), &reply.text)?;
                (Some(reply), finding)
            }
            Err(ModelError::NotSent(refused @ CallRefused::Ledger(_))) => {
                return Err(RunError::failed(refused));
            }
            Err(error) => (None, failed(&error)),
        };
        let answer = reply.as_ref().map(|reply| reply.text.clone());
        self.answer = answer.unwrap_or_default();
        let asked = Asked {
            sent,
            usage: reply.as_ref().and_then(|reply| reply.usage),
            ..Asked::new(&stage.name, self.asked, finding)
        };
        Ok(Attempt { asked, reply, took })
    }

    /// Adds a refused answer, why it was refused and, if the task asks for that, a picture of its action.
    fn correct(&mut self, at: Setting<'_>, refusal: &Refusal) -> Result<(), RenderError> {
        self.say_answer(refusal.answer.clone());
        let program = at.view.program;
        // The message of a declared check says where in the source its texts stand.
        let mut checks = program.verify.checks.iter();
        let check = checks.find(|declared| declared.name == refusal.check);
        let declared = match (check, &refusal.proposal) {
            (Some(check), Some(proposal)) => {
                let facts = at.facts();
                let facts = facts.judging(proposal);
                render::text(program, &check.message, Values::Known(facts))?
            }
            _ => None,
        };
        let same = declared.filter(|said| said.text == refusal.why);
        let mut said = same.unwrap_or_else(|| PromptText::by_fabc(refusal.why.clone()));
        let action = refusal.proposal.as_ref();
        let picture = action.and_then(|it| self.refused_action(at, it));
        if picture.is_some() {
            said.push(SEPARATOR, PromptText::by_fabc(REFUSED_ACTION));
        }
        let mut correction = StageMessage::text(Speaker::User, said);
        let picture = picture.map(|png| MessagePart::Added("the refused action", png));
        correction.parts.extend(picture);
        self.messages.push(correction);
        Ok(())
    }

    /// Draws a refused action on the stage's picture, if the task asks for that.
    ///
    /// Also `None` if the answer leads nowhere, for example with a distance that was never offered.
    fn refused_action(&self, at: Setting<'_>, proposal: &Proposal) -> Option<Png> {
        let Setting { view, stage, .. } = at;
        let (program, pictures) = (view.program, view.pictures);
        if !program.verify.with_picture || stage.model == ModelRole::Text {
            return None;
        }
        let action = Action::lower(program, proposal, view.scene, view.observation)?;
        let layers = Picture::Scene {
            layers: Layers::Drawn,
        };
        let mut drawn = if stage.show.contains(&layers) {
            pictures.annotated.clone()
        } else {
            pictures.scene.clone()
        };
        fab_vision::draw_action(&mut drawn, action.pick_px, action.place_px).ok()?;
        Some(scene_png(&drawn, &at.lowering, &self.notation))
    }
}

/// Converts a question without an answer into the rollout's finding.
fn failed(error: &ModelError) -> Finding {
    let (outcome, fault) = match error {
        ModelError::Failed { fault, .. } => (Outcome::ModelFailed, Some(*fault)),
        ModelError::Unsupported { .. } => (Outcome::ModelFailed, None),
        ModelError::NotSent(CallRefused::Interrupted) => (Outcome::Interrupted, None),
        ModelError::NotSent(_) => (Outcome::BudgetExhausted, None),
    };
    Finding::Failed {
        outcome,
        fault,
        why: error.to_string(),
    }
}

/// Returns the message about the previous action, if the step is being retried.
fn remark(view: StepView<'_>, facts: Facts<'_>) -> Result<Option<PromptText>, RenderError> {
    let program = view.program;
    let (Some(before), Some(check)) = (view.before, &program.verify.result) else {
        return Ok(None);
    };
    let overlap = format!("{:.0}%", before.overlap * 100.0);
    let texts = BTreeMap::from([(OVERLAP.to_owned(), overlap)]);
    let facts = Facts {
        texts: &texts,
        ..facts
    };
    render::text(program, &check.message, Values::Known(facts))
}
