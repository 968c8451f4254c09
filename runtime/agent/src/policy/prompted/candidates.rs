//! A stage whose answers are tried on twins: several are asked for and the best is taken, or the model sees what would
//! come of its answer and may revise it.
//!
//! In: the stage, its models, and twins that can be trusted. Out: the answer that is taken, and in the twins' line each
//! answer with its measure. The first candidate asks exactly what is asked without rehearsal.

use super::attempts::{Answer, Attempts};
use super::{Asked, ask};
use crate::action::Action;
use crate::outcome::Outcome;
use crate::policy::{Accepted, Exchange, Finding, PolicyError, StepView};
use crate::twins::{Interrupted, Twins, Untried};
use fab_model::{Model, Png};
use fab_picture::png;
use fab_program::verify::Verdict;
use fab_program::{Proposal, Rehearsal, Stage};
use fab_world::Motion;
use std::collections::BTreeMap;

/// What the model is told with the picture of what would come of its answer.
const PREDICTED: &str = "The picture shows how the cloth would lie after this action, as a simulation predicts it. Answer once more, in the same format: with the same action if the cloth would lie as it should, otherwise with a better one.";

/// By how much a measure must differ to decide anything: silhouettes are compared to about a hundredth.
const NOTICEABLE: f64 = 0.01;

/// An accepted answer, and what would come of it.
struct Candidate<'a> {
    proposal: Proposal,
    accepted: Accepted,
    motion: Option<Motion>,
    measure: Option<f64>,
    attempts: Attempts<'a>,
    /// The answer's text.
    reply: String,
}

/// How many questions a stage has asked in a step.
#[derive(Default)]
struct Count {
    all: u32,
    /// Those that are asked without rehearsal too.
    anyway: u32,
}

/// Asks a stage for its candidates, and returns the best.
pub(super) fn answer<'a>(
    step: StepView<'a>,
    (stage, rehearsal): (&'a Stage, &Rehearsal),
    model: &dyn Model,
    texts: &BTreeMap<String, String>,
    exchange: &mut Exchange<'_, '_>,
) -> Result<Answer, PolicyError> {
    let mut asked = Count::default();
    let of = (stage, rehearsal);
    let answer = chosen(step, of, model, texts, exchange, &mut asked)?;
    if let Some(twins) = exchange.twins.as_deref_mut() {
        let taken = match &answer {
            Answer::Action { accepted, .. } => Some(accepted.attempt),
            Answer::Text { .. } | Answer::None(_) => None,
        };
        twins.record_choice(taken, asked.all - asked.anyway);
    }
    Ok(answer)
}

fn chosen<'a>(
    step: StepView<'a>,
    (stage, rehearsal): (&'a Stage, &Rehearsal),
    model: &dyn Model,
    texts: &BTreeMap<String, String>,
    exchange: &mut Exchange<'_, '_>,
    asked: &mut Count,
) -> Result<Answer, PolicyError> {
    let count = rehearsal.choose.map_or(1, |_| stage.candidates());
    let mut best: Option<Candidate<'a>> = None;
    let (mut without, mut unusable) = (None, 0);
    for number in 0..count {
        let Asked {
            answer,
            attempts,
            reply,
            failed,
        } = ask((step, stage), model, texts, exchange, (number, asked.all))?;
        asked.all += attempts.asked();
        if number == 0 {
            asked.anyway = asked.all;
        }
        match answer {
            Answer::Action { proposal, accepted } => {
                let mut candidate = Candidate {
                    motion: lowered(step, &proposal),
                    measure: None,
                    proposal,
                    accepted,
                    attempts,
                    reply,
                };
                match tried(&mut candidate, exchange) {
                    // An answer that could not be tried has no measure.
                    Ok(()) | Err(Untried::Failed) => {}
                    Err(Untried::Interrupted) => return Ok(Answer::None(Outcome::Interrupted)),
                }
                if best.as_ref().is_none_or(|best| is_better(&candidate, best)) {
                    best = Some(candidate);
                }
            }
            // Only the model's own faults leave the others a chance.
            Answer::None(outcome @ (Outcome::AttemptsExhausted | Outcome::MalformedReply)) => {
                without.get_or_insert(outcome);
                unusable += 1;
            }
            // Without rehearsal it would not have been asked, so the answers that came still count.
            Answer::None(outcome) if number > 0 && outcome != Outcome::Interrupted => {
                let why = failed.unwrap_or_default();
                fall_short(
                    exchange,
                    format!(
                        "candidate {} of {count} was not answered, and no more were asked for: {why}",
                        number + 1
                    ),
                );
                break;
            }
            other => return Ok(other),
        }
    }
    let Some(mut best) = best else {
        return Ok(Answer::None(without.unwrap_or(Outcome::MalformedReply)));
    };
    if unusable > 0 {
        fall_short(
            exchange,
            format!("{unusable} of {count} candidates were not usable after all their attempts"),
        );
    }
    let revised = revise(&mut best, step, rehearsal, model, texts, exchange, asked)?;
    Ok(match revised {
        Ok(()) => Answer::Action {
            proposal: best.proposal,
            accepted: best.accepted,
        },
        Err(Interrupted) => Answer::None(Outcome::Interrupted),
    })
}

fn fall_short(exchange: &mut Exchange<'_, '_>, why: String) {
    if let Some(twins) = exchange.twins.as_deref_mut() {
        twins.record_shortfall(why);
    }
}

/// Returns the motion of a proposal; `None` if it leads nowhere, which the rollout reports if it is taken.
fn lowered(step: StepView<'_>, proposal: &Proposal) -> Option<Motion> {
    let action = Action::lower(step.program, proposal, step.scene, step.observation)?;
    Some(action.grip.into())
}

/// Folds a candidate on the twins.
fn tried(candidate: &mut Candidate<'_>, exchange: &mut Exchange<'_, '_>) -> Result<(), Untried> {
    let (Some(twins), Some(motion)) = (exchange.twins.as_deref_mut(), &candidate.motion) else {
        return Ok(());
    };
    let attempt = candidate.accepted.attempt;
    candidate.measure = twins.try_action(attempt, motion, exchange.interrupt)?;
    Ok(())
}

/// Returns whether a candidate is better than an earlier one. An answer that passes every check comes before one that
/// is accepted without some; of those that measure alike, the earlier is taken.
fn is_better(candidate: &Candidate<'_>, earlier: &Candidate<'_>) -> bool {
    let is_whole = |it: &Candidate<'_>| it.accepted.without.is_empty();
    match (is_whole(candidate), is_whole(earlier)) {
        (true, false) => return true,
        (false, true) => return false,
        _ => {}
    }
    match (candidate.measure, earlier.measure) {
        (Some(measure), Some(before)) => measure > before + NOTICEABLE,
        (Some(_), None) => true,
        (None, _) => false,
    }
}

/// The highest measure among an answer and its revisions.
struct Best(Option<f64>);

impl Best {
    /// Returns whether a revision may replace the answer before it: it measures at most a hundredth less than the best
    /// so far, so that several revisions together lose no more than that.
    fn admits(&mut self, revision: Option<f64>) -> bool {
        if let (Some(revision), Some(best)) = (revision, self.0)
            && revision < best - NOTICEABLE
        {
            return false;
        }
        self.0 = revision.into_iter().chain(self.0).reduce(f64::max);
        true
    }
}

/// Shows the model what would come of its answer, as often as the task says, and takes on what it answers then.
///
/// An answer that does not come, cannot be read, is refused, or is measured as worse leaves the one before it.
fn revise(
    taken: &mut Candidate<'_>,
    step: StepView<'_>,
    rehearsal: &Rehearsal,
    model: &dyn Model,
    texts: &BTreeMap<String, String>,
    exchange: &mut Exchange<'_, '_>,
    asked: &mut Count,
) -> Result<Result<(), Interrupted>, PolicyError> {
    let shown = |twins: &Twins, motion: &Motion| {
        let picture = twins.picture(motion)?;
        let sent = model.lowering().resized(picture).into_owned();
        Some(Png::new(png::encode(&sent)))
    };
    let mut best = Best(taken.measure);
    for number in 1..=rehearsal.revisions {
        let twins = exchange.twins.as_deref();
        let predicted = twins.zip(taken.motion.as_ref());
        let Some(png) = predicted.and_then(|(twins, motion)| shown(twins, motion)) else {
            break;
        };
        taken.attempts.show_prediction(&taken.reply, PREDICTED, png);
        taken.attempts.number_after(asked.all);
        let attempt = taken.attempts.ask(model, exchange, texts)?;
        asked.all += 1;
        let reply = attempt.reply.as_ref();
        let reply = reply.map(|it| it.text.clone()).unwrap_or_default();
        let fields = match attempt.finding {
            Finding::Action {
                fields,
                verdict: Verdict::Accept,
                ..
            } => fields,
            Finding::Failed {
                outcome: Outcome::Interrupted,
                ..
            } => return Ok(Err(Interrupted)),
            Finding::Failed { why, .. } => {
                let why = format!("revision {number} was not answered: {why}");
                fall_short(exchange, why);
                break;
            }
            _ => break,
        };
        let proposal = Proposal { fields };
        if proposal == taken.proposal {
            break;
        }
        let accepted = Accepted {
            stage: attempt.stage,
            attempt: attempt.number,
            without: Vec::new(),
        };
        let motion = lowered(step, &proposal);
        let tried = match (exchange.twins.as_deref_mut(), &motion) {
            (Some(twins), Some(motion)) => {
                twins.try_action(accepted.attempt, motion, exchange.interrupt)
            }
            _ => break,
        };
        let measure = match tried {
            Ok(measure) => measure,
            Err(Untried::Interrupted) => return Ok(Err(Interrupted)),
            Err(Untried::Failed) => break,
        };
        if !best.admits(measure) {
            break;
        }
        (taken.proposal, taken.accepted) = (proposal, accepted);
        (taken.motion, taken.measure, taken.reply) = (motion, measure, reply);
    }
    Ok(Ok(()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn revisions_together_lose_no_more_than_a_hundredth_of_the_best() {
        let admitted = |measures: [f64; 3]| {
            let mut best = Best(Some(0.9));
            measures.map(|measure| best.admits(Some(measure)))
        };
        assert_eq!(admitted([0.894, 0.888, 0.895]), [true, false, true]);
        assert_eq!(admitted([0.95, 0.93, 0.945]), [true, false, true]);
        let mut unmeasured = Best(None);
        assert!(unmeasured.admits(None));
    }
}
