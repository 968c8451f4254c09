//! What stages say, and what they would say after given answers: a step without a model.
//!
//! In: where the step stands, and answers in the order of the questions. Out: each stage's conversation with what came
//! of each answer, by the same code as a rollout's. Where the answers end, later stages are shown with placeholders
//! for what only a model can say.

use super::talk::{Answer, Missing, Next, Talk};
use super::{Conversation, PromptError};
use crate::policy::{Finding, StepView};
use fab_model::{Lowering, Reply};
use fab_program::{ModelRole, Stage};
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

/// A stage, its conversation, and what the answers in it meant.
#[derive(Clone, Debug)]
pub struct Rehearsed {
    /// The stage.
    pub stage: String,
    /// All that is said until its next question, or until its last answer.
    pub conversation: Conversation,
    /// How many of its messages were there before the first answer.
    pub n_asked_first: usize,
    /// What came of each answer, in order.
    pub findings: Vec<Finding>,
}

/// Goes through stages of a step as a rollout does, with answers at hand instead of a model.
///
/// - `stages`: the stages to go through, in the program's order.
/// - `lowering`: how the model of a role is told of points and pictures.
/// - `answers`: the first is for the first question, and so on; each stage takes as many as it asks for.
///
/// Returns the answers that no question asked for, too. Fails where a stage cannot be asked so.
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
        let mut talk = Talk::begin(view, stage, &texts, lowering, Missing::IsShown)?;
        let n_asked_first = talk.conversation().messages.len();
        let mut findings = Vec::new();
        let mut read = None;
        while let Some(text) = answers.pop_front() {
            let request = talk.request();
            let reply = Reply::text(text);
            let attempt = talk.answered(request, reply, Duration::ZERO, &texts)?;
            findings.push(attempt.finding.clone());
            if let Next::Done(answer) = talk.conclude(attempt, &texts)? {
                read = Some(answer);
                break;
            }
        }
        rehearsed.push(Rehearsed {
            stage: stage.name.clone(),
            n_asked_first,
            conversation: talk.conversation().clone(),
            findings,
        });
        match read {
            Some(Answer::Text { name, value }) => {
                texts.insert(name, value);
            }
            // A rollout ends here; nothing is asked after it.
            Some(Answer::None(_)) => break,
            Some(Answer::Action { .. }) | None => {}
        }
    }
    Ok((rehearsed, answers.into()))
}
