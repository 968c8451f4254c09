//! The loop of policies that propose actions themselves: judge, and after a refusal propose again with the reason.
//!
//! In: a step, and a function that proposes. Out: every attempt as it happens, and a [`Decision`]. The task's
//! `attempts` limit the number of proposals, as they limit a model's answers.

use super::judge::{relaxed, verdict};
use super::{
    Accepted, Attempt, Decision, Exchange, Exchanged, Finding, PolicyError, Question, StepView,
};
use crate::outcome::Outcome;
use fab_model::Reply;
use fab_program::Proposal;
use fab_program::verify::{OFFERED, Strictness, Verdict};
use std::collections::BTreeMap;
use std::time::Instant;

/// The stage name in attempts of a policy without stages.
pub(super) const STAGE: &str = "policy";

/// A proposal, with its question and reply.
pub(super) struct Proposed {
    /// The question, if there was one.
    pub question: Option<Question>,
    /// The reply, if there was one.
    pub reply: Option<Reply>,
    /// A note for people.
    pub note: Option<String>,
    /// The proposal, or why there is none.
    pub answer: Answer,
}

/// What a policy proposes.
pub(super) enum Answer {
    /// An action for the only gripper.
    Grip(Proposal),
    /// Nothing that can be judged; it may try again.
    Unreadable {
        /// The field that is wrong.
        field: String,
        /// What is wrong, and what would be right.
        message: String,
    },
    /// Nothing, now or later.
    Stop {
        /// How the rollout ends.
        outcome: Outcome,
        /// Why.
        why: String,
    },
}

/// A proposal that was not accepted.
pub(super) struct Refusal {
    /// The proposal, if it could be read.
    pub proposal: Option<Proposal>,
    /// The check that refused it, or the field that could not be read.
    pub check: String,
    /// Why, in words.
    pub why: String,
}

/// Proposes an action, given the refusals so far.
type Propose<'p> =
    dyn FnMut(&[Refusal], &mut Exchange<'_, '_>) -> Result<Proposed, PolicyError> + 'p;

/// Collects proposals until one passes every check.
pub(super) fn until_accepted(
    step: &StepView<'_>,
    exchange: &mut Exchange<'_, '_>,
    propose: &mut Propose<'_>,
) -> Result<Decision, PolicyError> {
    let texts = BTreeMap::new();
    let facts = step.facts(&texts, step.pixels());
    let mut refusals: Vec<Refusal> = Vec::new();
    let mut refused = Vec::new();
    for number in 1..=step.program.verify.attempts {
        let begun = Instant::now();
        let proposed = propose(&refusals, exchange)?;
        let took = begun.elapsed();
        if let Answer::Stop {
            outcome: outcome @ Outcome::Interrupted,
            why,
        } = proposed.answer
        {
            return Ok(Decision::Stop { outcome, why });
        }
        let finding = match &proposed.answer {
            Answer::Grip(proposal) => Finding::Action {
                fields: proposal.fields.clone(),
                repairs: Vec::new(),
                stated: Vec::new(),
                verdict: verdict(*step, facts, proposal, Strictness::Full)?,
            },
            Answer::Unreadable { field, message } => Finding::Malformed {
                stated: Vec::new(),
                field: field.clone(),
                message: message.clone(),
            },
            Answer::Stop { outcome, why } => Finding::Failed {
                outcome: *outcome,
                fault: None,
                why: why.clone(),
            },
        };
        (exchange.record)(Exchanged::Attempt(&Attempt {
            stage: STAGE.to_owned(),
            number,
            question: proposed.question,
            reply: proposed.reply,
            note: proposed.note,
            finding: finding.clone(),
            took,
        }))?;
        match (proposed.answer, finding) {
            (Answer::Stop { outcome, why }, _) => return Ok(Decision::Stop { outcome, why }),
            (Answer::Unreadable { field, message }, _) => refusals.push(Refusal {
                proposal: None,
                check: field,
                why: message,
            }),
            (
                Answer::Grip(proposal),
                Finding::Action {
                    verdict: Verdict::Reject { check, message, .. },
                    ..
                },
            ) => {
                refused.push((number, proposal.clone()));
                refusals.push(Refusal {
                    proposal: Some(proposal),
                    check,
                    why: message,
                });
            }
            (Answer::Grip(proposal), _) => return Ok(act(proposal, number, &[])),
        }
    }
    if let Some((number, proposal)) = relaxed(*step, facts, &refused)? {
        return Ok(act(proposal, number, &step.program.verify.relaxed));
    }
    // A proposal outside the action space is a failure of the policy, not a bad choice.
    let is_outside = |refusal: &&Refusal| refusal.proposal.is_none() || refusal.check == OFFERED;
    Ok(match refusals.last().filter(is_outside) {
        Some(refusal) => Decision::Stop {
            outcome: Outcome::PolicyFailed,
            why: format!("its answer is outside of the action space: {}", refusal.why),
        },
        None => step.without_answer(Outcome::AttemptsExhausted),
    })
}

fn act(proposal: Proposal, attempt: u32, without: &[String]) -> Decision {
    Decision::Act {
        grips: vec![proposal],
        accepted: Accepted {
            stage: STAGE.to_owned(),
            attempt,
            without: without.to_owned(),
        },
    }
}
