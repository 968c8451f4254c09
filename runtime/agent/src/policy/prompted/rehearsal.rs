//! Rehearses a step without a model: what its stages say, and how they react to given answers.
//!
//! In: the step's state, and answers in the order of the questions. Out: each stage's conversation with the result of
//! each answer, by the same code as a rollout. When the answers run out, later stages are shown with placeholders for a
//! model's texts.

use super::attempts::{Answer, Attempts, Missing, Next};
use super::{Conversation, PromptError};
use crate::policy::{Finding, StepView};
use fab_model::{Lowering, Reply};
use fab_program::{ModelRole, Stage};
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

/// A stage, its conversation, and the results of its answers.
#[derive(Clone, Debug)]
pub struct Rehearsed {
    /// The stage.
    pub stage: String,
    /// All messages up to its next question, or its last answer.
    pub conversation: Conversation,
    /// The number of messages before the first answer.
    pub n_asked_first: usize,
    /// The result of each answer, in order.
    pub findings: Vec<Finding>,
}

/// Runs stages of a step as a rollout does, with given answers instead of a model.
///
/// - `stages`: the stages to go through, in the program's order.
/// - `lowering`: the lowering of each role's model.
/// - `answers`: in the order of the questions; each stage takes as many as it asks for.
///
/// Also returns the answers left over. Fails if a stage cannot be asked this way.
pub fn rehearse(
    view: StepView<'_>,
    stages: &[&Stage],
    lowering: &dyn Fn(ModelRole) -> Lowering,
    answers: Vec<String>,
) -> Result<(Vec<Rehearsed>, Vec<String>), PromptError> {
    let mut texts = BTreeMap::new();
    let mut answers = VecDeque::from(answers);
    let mut rehearsed = Vec::with_capacity(stages.len());
    for stage in stages {
        let lowering = lowering(stage.model);
        let mut attempts = Attempts::begin(view, stage, &texts, lowering, Missing::IsShown)?;
        let n_asked_first = attempts.conversation().messages.len();
        let mut findings = Vec::new();
        let mut read = None;
        while let Some(text) = answers.pop_front() {
            let request = attempts.request();
            let reply = Reply::text(text);
            let attempt = attempts.answered(request, reply, Duration::ZERO, &texts)?;
            findings.push(attempt.finding.clone());
            if let Next::Done(answer) = attempts.conclude(attempt, &texts)? {
                read = Some(answer);
                break;
            }
        }
        rehearsed.push(Rehearsed {
            stage: stage.name.clone(),
            n_asked_first,
            conversation: attempts.conversation().clone(),
            findings,
        });
        match read {
            Some(Answer::Text { name, value }) => {
                texts.insert(name, value);
            }
            // A rollout would end here and ask nothing more.
            Some(Answer::None(_)) => break,
            Some(Answer::Action { .. }) | None => {}
        }
    }
    Ok((rehearsed, answers.into()))
}
