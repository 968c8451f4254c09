//! Rehearses a step without a model: what its stages say, and how they react to given answers.
//!
//! In: the step's state, and answers in the order of the questions. Out: each stage's conversation with the result of
//! each answer, by the same code as a rollout. When the answers run out, later stages are shown with placeholders for a
//! model's texts.

use super::StageMessage;
use super::dialogue::{Dialogue, Setting};
use crate::policy::proposing::Settled;
use crate::policy::{Asking, Exchange, Exchanged, Finding, RunError, StepView};
use crate::record::SentFiles;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Budget, CallRefused, Calls, Ledger};
use fab_model::{Lowering, Model, ModelError, ModelKind, Reply, Request};
use fab_program::Stage;
use fab_program::render::Values;
use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, PoisonError};

/// A stage, its conversation, and the results of its answers.
#[derive(Clone, Debug)]
pub struct Rehearsed {
    /// The stage.
    pub stage: String,
    /// All messages up to its next question, or its last answer.
    pub conversation: Vec<StageMessage>,
    /// The number of messages before the first answer.
    pub n_asked_first: usize,
    /// The result of each answer, in order.
    pub findings: Vec<Finding>,
}

/// Gives these answers in turn, and then none.
struct Given {
    lowering: Lowering,
    answers: Mutex<VecDeque<String>>,
}

impl Model for Given {
    fn name(&self) -> &str {
        "given"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn lowering(&self) -> Lowering {
        self.lowering
    }

    fn ask(&self, _: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let mut answers = self.answers.lock().unwrap_or_else(PoisonError::into_inner);
        let answer = answers.pop_front().ok_or(CallRefused::Interrupted)?;
        Ok(Reply::text(answer))
    }
}

/// Runs stages of a step as a rollout does, with given answers instead of a model.
///
/// - `stages`: the stages to go through, in the program's order.
/// - `lowering`: that of the model which would answer.
/// - `answers`: in the order of the questions; each stage takes as many as it asks for.
///
/// Also returns the answers left over. Fails if a stage cannot be asked this way.
pub fn rehearse(
    view: StepView<'_>,
    stages: &[&Stage],
    lowering: Lowering,
    answers: Vec<String>,
) -> Result<(Vec<Rehearsed>, Vec<String>), RunError> {
    let answers = Mutex::new(answers.into());
    let given = Given { lowering, answers };
    let budget = Budget::default();
    let mut texts = BTreeMap::new();
    let mut rehearsed = Vec::with_capacity(stages.len());
    for stage in stages {
        let at = Setting {
            view,
            stage,
            texts: &texts,
            model: &given,
        };
        let mut dialogue = Dialogue::begin(at, Values::Partly, [0, 0])?;
        let n_asked_first = dialogue.messages.len();
        let mut findings = Vec::new();
        let mut exchange = Exchange {
            asking: &mut Asking::of(Ledger::unwritten(&budget)),
            record: &mut |exchanged| {
                if let Exchanged::Attempt(attempt) = exchanged
                    && attempt.reply.is_some()
                {
                    findings.push(attempt.asked.result.clone());
                }
                Ok(SentFiles::default())
            },
            interrupt: &Interrupt::default(),
        };
        let settled = dialogue.settle(at, view.program.verify.attempts, &mut exchange)?;
        rehearsed.push(Rehearsed {
            stage: stage.name.clone(),
            n_asked_first,
            conversation: dialogue.messages,
            findings,
        });
        match settled {
            Settled::Text { name, value } => {
                texts.insert(name, value);
            }
            // A rollout would end here and ask nothing more.
            Settled::Refused(_) => break,
            Settled::Action(..) | Settled::Failed { .. } => {}
        }
    }
    let left = given.answers.into_inner();
    let left = left.unwrap_or_else(PoisonError::into_inner);
    Ok((rehearsed, left.into()))
}
