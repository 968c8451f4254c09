//! The conversation of one stage in one step: asks, and after a refusal asks again with the reason.

use super::{Conversation, PromptError, conversation};
use crate::action::Action;
use crate::outcome::Outcome;
use crate::pictures::scene_png;
use crate::policy::judge::{judge, relaxed};
use crate::policy::{
    Accepted, Attempt, Exchange, Exchanged, Finding, PolicyError, Question, StepView,
};
use fab_model::calls::CallRefused;
use fab_model::{Lowering, Model, ModelError, Png, Reply, Request, Speaker};
use fab_program::Proposal;
use fab_program::facts::Facts;
use fab_program::pointing::Notation;
use fab_program::render::{self, PromptText, REFUSED_ACTION, RenderError, SEPARATOR, Values};
use fab_program::reply;
use fab_program::space;
use fab_program::verify::Verdict;
use fab_program::{Layers, ModelRole, OVERLAP, Picture, Stage};
use serde_json::Value;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// The final result of a stage.
pub(super) enum Answer {
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

pub(super) enum Next {
    AskAgain,
    Done(Answer),
}

/// What to do about a text without an answer yet.
#[derive(Clone, Copy)]
pub(super) enum Missing {
    /// The stage cannot be asked.
    IsAnError,
    /// It is shown as words in angle brackets.
    IsShown,
}

/// The conversation of one stage in one step.
pub(super) struct Attempts<'a> {
    view: StepView<'a>,
    stage: &'a Stage,
    lowering: Lowering,
    /// The notation of the scene's points for the model.
    notation: Notation,
    conversation: Conversation,
    /// The schema of valid answers for this scene.
    schema: Value,
    asked: u32,
    /// Which of several answers to one question is asked for, from 0.
    candidate: u32,
    /// Questions of this stage and step that other conversations asked before.
    asked_before: u32,
    /// Actions that were read and refused, oldest first, each with its question's number.
    refused: Vec<(u32, Proposal)>,
}

impl<'a> Attempts<'a> {
    pub(super) fn begin(
        view: StepView<'a>,
        stage: &'a Stage,
        texts: &BTreeMap<String, String>,
        lowering: Lowering,
        missing: Missing,
    ) -> Result<Self, PromptError> {
        let StepView {
            program,
            pictures,
            step,
            ..
        } = view;
        let facts = view.facts(texts, lowering.pointing(pictures.size()));
        let values = match missing {
            Missing::IsAnError => Values::Known(facts),
            Missing::IsShown => Values::Partly(facts),
        };
        let mut conversation = conversation(program, stage, values, pictures, step, &lowering)?;
        if let Some(remark) = remark(view, facts)? {
            conversation.add(remark);
        }
        let notation = facts.notation(program);
        let fields = program.actions.iter();
        let offered: Vec<_> = fields
            .map(|field| (field.name.clone(), space::choices(field, view.scene)))
            .collect();
        Ok(Attempts {
            view,
            stage,
            lowering,
            conversation,
            schema: reply::for_stage(program, stage, &notation, &offered),
            notation,
            asked: 0,
            candidate: 0,
            asked_before: 0,
            refused: Vec::new(),
        })
    }

    /// Asks for one of several answers.
    ///
    /// - `candidate`: which one, from 0.
    /// - `asked`: questions of this stage and step so far.
    pub(super) fn be_candidate(&mut self, candidate: u32, asked: u32) {
        (self.candidate, self.asked_before) = (candidate, asked);
    }

    /// Returns how many questions it has asked.
    pub(super) fn asked(&self) -> u32 {
        self.asked
    }

    /// Numbers the next question after all that this stage and step has asked so far, by whichever conversation.
    pub(super) fn number_after(&mut self, asked: u32) {
        self.asked_before = asked - self.asked;
    }

    /// Adds an answer, and what would come of it.
    pub(super) fn show_prediction(&mut self, answer: &str, words: &str, png: Png) {
        self.say_answer(answer.to_owned());
        let words = PromptText::by_fabc(words.to_owned());
        self.conversation.say(Speaker::User, words);
        self.conversation.add_prediction(png);
    }

    fn say_answer(&mut self, text: String) {
        let stretches = Vec::new();
        let answer = PromptText { text, stretches };
        self.conversation.say(Speaker::Assistant, answer);
    }

    /// Asks the next question, and records it and its answer.
    pub(super) fn ask(
        &mut self,
        model: &dyn Model,
        exchange: &mut Exchange<'_, '_>,
        texts: &BTreeMap<String, String>,
    ) -> Result<Attempt, PolicyError> {
        let request = self.request();
        (exchange.record)(Exchanged::Question {
            stage: &self.stage.name,
            attempt: self.asked_before + self.asked,
            question: &Question::Prompt(Box::new(request.clone())),
        })?;
        let begun = Instant::now();
        let answered = exchange.asking.ask(model, &request);
        let took = begun.elapsed();
        let attempt = match answered {
            Ok(reply) => self.answered(request, reply, took, texts)?,
            Err(ModelError::NotSent(
                refused @ (CallRefused::NotNoted(_) | CallRefused::NotKept(_) | CallRefused::Lost),
            )) => return Err(PolicyError::Calls(refused)),
            Err(error) => self.attempt(request, None, failed(&error), took),
        };
        (exchange.record)(Exchanged::Attempt(&attempt))?;
        Ok(attempt)
    }

    /// Returns the question and counts it as asked.
    pub(super) fn request(&mut self) -> Request {
        self.asked += 1;
        Request {
            role: self.stage.model,
            messages: self.conversation.messages.clone(),
            temperature: self.stage.temperature,
            top_p: self.stage.top_p,
            max_tokens: self.stage.max_tokens,
            reasoning: self.stage.reasoning,
            repetition: self.view.repetition,
            start: self.view.start_number,
            step: self.view.number,
            candidate: self.candidate,
            schema: Some(self.schema.clone()),
        }
    }

    /// Reads and judges the answer to a question.
    pub(super) fn answered(
        &self,
        request: Request,
        reply: Reply,
        took: Duration,
        texts: &BTreeMap<String, String>,
    ) -> Result<Attempt, RenderError> {
        let facts = self.facts(texts);
        let finding = judge(self.view, self.stage, facts, &reply.text)?;
        Ok(self.attempt(request, Some(reply), finding, took))
    }

    fn attempt(
        &self,
        request: Request,
        reply: Option<Reply>,
        finding: Finding,
        took: Duration,
    ) -> Attempt {
        Attempt {
            stage: self.stage.name.clone(),
            number: self.asked_before + self.asked,
            question: Some(Question::Prompt(Box::new(request))),
            reply,
            note: None,
            finding,
            took,
        }
    }

    pub(super) fn conclude(
        &mut self,
        attempt: Attempt,
        texts: &BTreeMap<String, String>,
    ) -> Result<Next, RenderError> {
        let mut picture = None;
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
            Finding::Failed { outcome, .. } => {
                return Ok(Next::Done(Answer::None(outcome)));
            }
            Finding::Action {
                fields,
                verdict: Verdict::Reject { check, message, .. },
                ..
            } => {
                let proposal = Proposal { fields };
                let said = self.refusal(&check, message, &proposal, texts)?;
                picture = self.refused_action(&proposal);
                self.refused.push((attempt.number, proposal));
                (said, Outcome::AttemptsExhausted)
            }
            Finding::Malformed { message, .. } => {
                (PromptText::by_fabc(message), Outcome::MalformedReply)
            }
        };
        if self.asked >= self.view.program.verify.attempts {
            let without = &self.view.program.verify.relaxed;
            let relaxed = relaxed(self.view, self.facts(texts), &self.refused)?;
            return Ok(Next::Done(match relaxed {
                Some((number, proposal)) => self.accept(proposal, number, without),
                None => Answer::None(outcome),
            }));
        }
        let answer = attempt.reply.map(|reply| reply.text).unwrap_or_default();
        self.correct(answer, correction, picture);
        Ok(Next::AskAgain)
    }

    /// Returns a verdict's message with its source position; for a refusal by `fabc` itself, its own words.
    fn refusal(
        &self,
        check: &str,
        message: String,
        proposal: &Proposal,
        texts: &BTreeMap<String, String>,
    ) -> Result<PromptText, RenderError> {
        let program = self.view.program;
        let checks = &program.verify.checks;
        let declared = checks.iter().find(|declared| declared.name == check);
        let facts = self.facts(texts);
        let facts = facts.judging(proposal);
        let said = match declared {
            Some(check) => render::text(program, &check.message, Values::Known(facts))?,
            None => None,
        };
        let same = said.filter(|said| said.text == message);
        Ok(same.unwrap_or_else(|| PromptText::by_fabc(message)))
    }

    /// Adds an answer and the correction.
    fn correct(&mut self, answer: String, mut correction: PromptText, picture: Option<Png>) {
        self.say_answer(answer);
        if picture.is_some() {
            correction.push(SEPARATOR, PromptText::by_fabc(REFUSED_ACTION));
        }
        self.conversation.say(Speaker::User, correction);
        if let Some(png) = picture {
            self.conversation.add_refused_action(png);
        }
    }

    /// Returns what has been said and sent so far.
    pub(super) fn conversation(&self) -> &Conversation {
        &self.conversation
    }

    fn facts<'t>(&'t self, texts: &'t BTreeMap<String, String>) -> Facts<'t> {
        self.view.facts(texts, *self.notation.pointing())
    }

    /// Draws a refused action on the stage's picture, if the task asks for that.
    ///
    /// Also `None` if the answer leads nowhere, for example with a distance that was never offered.
    fn refused_action(&self, proposal: &Proposal) -> Option<Png> {
        let StepView {
            program,
            scene,
            observation,
            pictures,
            ..
        } = self.view;
        if !program.verify.with_picture || self.stage.model == ModelRole::Text {
            return None;
        }
        let action = Action::lower(program, proposal, scene, observation)?;
        let layers = Picture::Scene {
            layers: Layers::Drawn,
        };
        let mut drawn = if self.stage.show.contains(&layers) {
            pictures.annotated.clone()
        } else {
            pictures.scene.clone()
        };
        fab_vision::draw_action(&mut drawn, action.pick_px, action.place_px).ok()?;
        Some(scene_png(&drawn, &self.lowering, &self.notation))
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

/// Converts a question without an answer into the rollout's finding.
fn failed(error: &ModelError) -> Finding {
    let (outcome, fault) = match error {
        ModelError::Failed { fault, .. } => (Outcome::ModelFailed, Some(*fault)),
        ModelError::Unsupported { .. } => (Outcome::ModelFailed, None),
        ModelError::NotSent(_) => (Outcome::BudgetExhausted, None),
        ModelError::Interrupted => (Outcome::Interrupted, None),
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
