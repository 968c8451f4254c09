//! Rehearses a step without a model: what its stages say, and how they react to given answers.
//!
//! In: the step's state, and answers in the order of the questions. Out: each stage's conversation with the result of
//! each answer, by the same code as a rollout. When the answers run out, later stages are shown with placeholders for a
//! model's texts.

use super::StageMessage;
use super::dialogue::{Answers, Dialogue, Setting};
use crate::policy::proposing::Settled;
use crate::policy::{Asking, Exchange, Exchanged, Finding, RunError, StepView};
use crate::record::SentFiles;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Budget, Ledger};
use fab_model::{Lowering, Models, Request};
use fab_program::render::Values;
use fab_program::{Read, Stage, reply};
use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};

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

/// The first question of a stage.
#[derive(Clone, Debug)]
pub struct FirstQuestion {
    /// The stage.
    pub stage: String,
    /// The question, with words in angle brackets for texts that only a model can give; if the stage reads the action, its
    /// schema lacks the scene's values.
    pub request: Request,
}

/// Returns the first question of each stage in a step, before anything is asked.
pub fn first_questions(
    view: StepView<'_>,
    models: Models<'_>,
) -> Result<Vec<FirstQuestion>, RunError> {
    let (texts, answers) = (BTreeMap::new(), RefCell::default());
    let question = |stage: &Stage| {
        let at = Setting {
            view,
            stage,
            texts: &texts,
            lowering: models.of(stage.model).lowering(),
            answers: Answers::Given(&answers),
        };
        let mut request = Dialogue::begin(at, Values::Partly, 0)?.request(at);
        if stage.read == Read::Action {
            request.schema = Some(reply::static_schema(view.program));
        }
        Ok(FirstQuestion {
            stage: stage.name.clone(),
            request,
        })
    };
    view.program.stages.iter().map(question).collect()
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
    let answers = RefCell::new(VecDeque::from(answers));
    let budget = Budget::default();
    let mut texts = BTreeMap::new();
    let mut rehearsed = Vec::with_capacity(stages.len());
    for stage in stages {
        let at = Setting {
            view,
            stage,
            texts: &texts,
            lowering,
            answers: Answers::Given(&answers),
        };
        let mut dialogue = Dialogue::begin(at, Values::Partly, 0)?;
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
    Ok((rehearsed, answers.into_inner().into()))
}
