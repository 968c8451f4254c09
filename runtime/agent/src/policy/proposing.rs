//! The loop of every policy: ask, judge, and after a refusal ask again with the reason.
//!
//! In: a step, and a function that makes an attempt. Out: every attempt as it happens, and what it came to. The task's
//! `attempts` limit the number of answers.

use super::{Accepted, Attempt, Decision, Exchange, Exchanged, Finding, RunError, StepView};
use crate::outcome::Outcome;
use crate::record::{Asked, SentFiles};
use fab_model::Reply;
use fab_program::Proposal;
use fab_program::facts::Facts;
use fab_program::verify::{OFFERED, Strictness, Verdict};
use std::time::Instant;

/// The stage name in attempts of a policy without stages.
pub(super) const STAGE: &str = "policy";

/// What a round of attempts came to.
pub(super) enum Settled {
    Text {
        name: String,
        value: String,
    },
    Action(Proposal, Accepted),
    /// No answer came.
    Failed {
        outcome: Outcome,
        why: String,
    },
    /// Every answer was refused or unreadable; the last one.
    Refused(Option<Refusal>),
}

/// An answer that was not accepted.
pub(super) struct Refusal {
    /// What it would be accepted as.
    pub accepted: Accepted,
    /// The action, if it could be read.
    pub proposal: Option<Proposal>,
    /// The check that refused it, or the field that could not be read.
    pub check: String,
    /// Why, in words.
    pub why: String,
    /// The answer as it came; empty if there was none.
    pub answer: String,
}

/// Makes an attempt, given the refusals so far.
type Ask<'p> = dyn FnMut(&[Refusal], &mut Exchange<'_, '_>) -> Result<Attempt, RunError> + 'p;

/// Makes at most so many attempts, until an answer is accepted.
pub(super) fn settle(
    step: &StepView<'_>,
    attempts: u32,
    facts: Facts<'_>,
    exchange: &mut Exchange<'_, '_>,
    ask: &mut Ask<'_>,
) -> Result<Settled, RunError> {
    let mut refusals = Vec::new();
    for _ in 0..attempts {
        let attempt = ask(&refusals, exchange)?;
        (exchange.record)(Exchanged::Attempt(&attempt))?;
        let accepted = Accepted {
            stage: attempt.asked.stage,
            attempt: attempt.asked.attempt,
            without: Vec::new(),
        };
        let (check, why, proposal) = match attempt.asked.result {
            Finding::Text { name, value, .. } => return Ok(Settled::Text { name, value }),
            Finding::Failed { outcome, why, .. } => return Ok(Settled::Failed { outcome, why }),
            Finding::Malformed(malformed) => (malformed.field, malformed.message, None),
            Finding::Action {
                fields, verdict, ..
            } => match (Proposal { fields }, verdict) {
                (proposal, Verdict::Accept) => return Ok(Settled::Action(proposal, accepted)),
                (proposal, Verdict::Reject { check, message, .. }) => {
                    (check, message, Some(proposal))
                }
            },
        };
        refusals.push(Refusal {
            accepted,
            proposal,
            check,
            why,
            answer: attempt.reply.map(|reply| reply.text).unwrap_or_default(),
        });
    }
    // The newest action that only a check refuses which the task drops in the end.
    let without = &step.program.verify.relaxed;
    let relaxed = refusals.iter().rev().filter(|_| !without.is_empty());
    for (refusal, proposal) in relaxed.filter_map(|it| Some((it, it.proposal.as_ref()?))) {
        let verdict = step.verdict(facts, proposal, Strictness::Relaxed)?;
        if verdict == Verdict::Accept {
            let accepted = Accepted {
                without: without.clone(),
                ..refusal.accepted.clone()
            };
            return Ok(Settled::Action(proposal.clone(), accepted));
        }
    }
    Ok(Settled::Refused(refusals.pop()))
}

/// An action for the only gripper, or why there is none.
pub(super) type Answer = Result<Proposal, Box<Finding>>;

/// How a policy without stages came to its answer.
#[derive(Default)]
pub(super) struct Source {
    /// The files of the question, if there was one.
    pub sent: SentFiles,
    pub reply: Option<Reply>,
    /// A note for people.
    pub note: Option<String>,
}

/// Proposes nothing, now or later.
pub(super) fn stop<T>(outcome: Outcome, why: impl Into<String>) -> Result<T, Box<Finding>> {
    Err(Box::new(Finding::Failed {
        outcome,
        fault: None,
        why: why.into(),
    }))
}

/// Proposes an action, given the refusals so far.
type Propose<'p> =
    dyn FnMut(&[Refusal], &mut Exchange<'_, '_>) -> Result<(Source, Answer), RunError> + 'p;

/// Collects proposals of a policy without stages until one passes every check.
pub(super) fn until_accepted(
    step: &StepView<'_>,
    exchange: &mut Exchange<'_, '_>,
    propose: &mut Propose<'_>,
) -> Result<Decision, RunError> {
    let facts = step.facts();
    let mut ask = |refusals: &[Refusal], exchange: &mut Exchange<'_, '_>| {
        let begun = Instant::now();
        let (Source { sent, reply, note }, answer) = propose(refusals, exchange)?;
        let took = begun.elapsed();
        let finding = match answer {
            Err(finding) => *finding,
            Ok(proposal) => Finding::Action {
                verdict: step.verdict(facts, &proposal, Strictness::Full)?,
                fields: proposal.fields,
                stated: Vec::new(),
            },
        };
        let asked = Asked {
            sent,
            note,
            ..Asked::new(STAGE, refusals.len() as u32 + 1, finding)
        };
        Ok(Attempt { asked, reply, took })
    };
    let attempts = step.program.verify.attempts;
    let settled = settle(step, attempts, facts, exchange, &mut ask)?;
    // A proposal outside the action space is a failure of the policy, not a bad choice.
    let is_outside = |refusal: &Refusal| refusal.proposal.is_none() || refusal.check == OFFERED;
    Ok(match settled {
        Settled::Action(proposal, accepted) => Decision::act(proposal, accepted),
        Settled::Failed { outcome, why } => Decision::Stop { outcome, why },
        Settled::Refused(Some(refusal)) if is_outside(&refusal) => Decision::Stop {
            outcome: Outcome::PolicyFailed,
            why: format!("its answer is outside of the action space: {}", refusal.why),
        },
        Settled::Refused(_) | Settled::Text { .. } => {
            step.without_answer(Outcome::AttemptsExhausted)
        }
    })
}
