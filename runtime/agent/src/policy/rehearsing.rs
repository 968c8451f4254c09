//! A policy that decides with twins at hand: any policy, and the twins of its rollout.
//!
//! In: each step, and what the world has done since the one before. Out: of the inner policy's answers the one that does
//! best on the twins; or a stop, where nothing may move because twins and camera disagree. The first answer is what the
//! inner policy decides by itself. Further ones are asked for as the task says: independent ones, then revisions of the
//! best. A policy without further answers has one, which is not tried.

use super::{Accepted, Decision, Description, Exchange, Exchanged, Policy, RunError, StepView};
use crate::action::Action;
use crate::outcome::Outcome;
use crate::twins::Twins;
use fab_program::{Program, Proposal};
use fab_world::Motion;

/// By how much a measure must differ to decide anything: silhouettes are compared to about a hundredth.
const NOTICEABLE: f64 = 0.01;

/// A policy around another one.
pub struct Rehearsing<'p> {
    inner: Box<dyn Policy + 'p>,
    twins: Twins<'p>,
}

/// An accepted answer, and what would come of it.
struct Candidate {
    /// Which of the policy's answers to the step it is, from 0.
    answer: u32,
    grips: Vec<Proposal>,
    accepted: Accepted,
    /// `None` if the answer leads nowhere, which the rollout reports if it is taken.
    motion: Option<Motion>,
    /// The mean over the twins; `None` if the task declares no measure, or the answer could not be tried.
    measure: Option<f64>,
}

impl<'p> Rehearsing<'p> {
    /// Lets a policy try its answers on twins.
    pub fn new(inner: Box<dyn Policy + 'p>, twins: Twins<'p>) -> Rehearsing<'p> {
        Rehearsing { inner, twins }
    }

    /// Asks for the answers that the task declares, and returns the best; the first decision, if none can be used.
    ///
    /// First come independent answers, then revisions of the best of these. A revision that does not come, cannot be
    /// read, is refused, or is measured as worse leaves the answer before it.
    fn best(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, RunError> {
        let first = self.inner.decide(step, exchange)?;
        if !self.inner.rehearses() {
            return Ok(first);
        }
        let interrupted = step.without_answer(Outcome::Interrupted);
        let rehearsal = self.twins.rehearsal;
        let mut stages = step.program.stages.iter();
        let stage = stages.find(|stage| stage.name == rehearsal.stage);
        let count = rehearsal.choose.and(stage).map_or(1, |it| it.candidates());
        let mut best: Option<Candidate> = None;
        for answer in 0..count {
            let decision = match answer {
                0 => first.clone(),
                _ => self.inner.decide(&StepView { answer, ..*step }, exchange)?,
            };
            match decision {
                Decision::Act { grips, accepted } => {
                    let candidate = self.tried(step, answer, (grips, accepted), exchange);
                    if exchange.interrupt.is_raised() {
                        return Ok(interrupted);
                    }
                    if best.as_ref().is_none_or(|best| candidate.is_better(best)) {
                        best = Some(candidate);
                    }
                }
                // Only the policy's own faults leave the others a chance.
                decision if decision.is_exhausted() => {}
                decision if decision.is_interrupted() => return Ok(decision),
                // Without rehearsal it would not have been asked, so the answers that came still count.
                _ => break,
            }
        }
        let Some(mut taken) = best else {
            return Ok(first);
        };
        let mut highest = taken.measure;
        for _ in 0..rehearsal.revisions {
            let Some(predicted) = self.twins.picture(taken.motion.as_ref()) else {
                break;
            };
            let view = StepView {
                answer: taken.answer,
                ..*step
            };
            let revision = match self.inner.revise(&view, exchange, predicted)? {
                Some(Decision::Act { grips, accepted })
                    if accepted.without.is_empty() && grips != taken.grips =>
                {
                    self.tried(step, taken.answer, (grips, accepted), exchange)
                }
                Some(decision) if decision.is_interrupted() => return Ok(decision),
                _ => break,
            };
            if exchange.interrupt.is_raised() {
                return Ok(interrupted);
            }
            let was_tried = self.twins.picture(revision.motion.as_ref()).is_some();
            if !was_tried || !admits(&mut highest, revision.measure) {
                break;
            }
            taken = revision;
        }
        Ok(Decision::Act {
            grips: taken.grips,
            accepted: taken.accepted,
        })
    }

    /// Tries an answer on the twins; one that cannot be tried has no measure.
    fn tried(
        &mut self,
        step: &StepView<'_>,
        answer: u32,
        (grips, accepted): (Vec<Proposal>, Accepted),
        exchange: &mut Exchange<'_, '_>,
    ) -> Candidate {
        let lowered = grips.iter().map(|proposal| {
            let action = Action::lower(step.program, proposal, step.scene, step.observation)?;
            Some(action.grip)
        });
        let motion = lowered.collect::<Option<_>>().map(|grips| Motion { grips });
        let (twins, interrupt) = (&mut self.twins, exchange.interrupt);
        let measured = motion.as_ref();
        let measured = measured.map(|it| twins.try_motion(accepted.attempt, it, interrupt));
        Candidate {
            answer,
            grips,
            accepted,
            motion,
            measure: measured.flatten(),
        }
    }
}

impl Candidate {
    /// Returns whether it is better than an earlier one. An answer that passes every check comes before one that is
    /// accepted without some; of those that measure alike, the earlier is taken.
    fn is_better(&self, earlier: &Candidate) -> bool {
        match [self, earlier].map(|it| it.accepted.without.is_empty()) {
            [true, false] => return true,
            [false, true] => return false,
            _ => {}
        }
        match (self.measure, earlier.measure) {
            (Some(measure), Some(before)) => measure > before + NOTICEABLE,
            (measure, _) => measure.is_some(),
        }
    }
}

/// Returns whether a revision may replace the answer before it: it measures at most a hundredth less than the highest so
/// far, so that several revisions together lose no more than that.
fn admits(highest: &mut Option<f64>, revision: Option<f64>) -> bool {
    if let (Some(revision), Some(highest)) = (revision, *highest)
        && revision < highest - NOTICEABLE
    {
        return false;
    }
    *highest = revision.into_iter().chain(*highest).reduce(f64::max);
    true
}

impl Policy for Rehearsing<'_> {
    fn description(&self) -> Description {
        self.inner.description()
    }

    fn varies(&self) -> bool {
        self.inner.varies()
    }

    fn prepare(&self, program: &Program) -> Result<(), RunError> {
        self.inner.prepare(program)
    }

    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, RunError> {
        let seen = (step.observation, step.scene.cloth());
        let (executed, interrupt) = (step.executed, exchange.interrupt);
        self.twins.look(step.step, seen, executed, interrupt);
        if interrupt.is_raised() {
            return Ok(Decision::Stop {
                outcome: Outcome::Interrupted,
                why: "interrupted".to_owned(),
            });
        }
        let decided = match (self.twins.refusal(), self.twins.line.aside.clone()) {
            (Some(why), _) => Ok(Decision::Stop {
                outcome: Outcome::RehearsalRefused,
                why,
            }),
            (None, Some(why)) => {
                let note = format!("step {} is not rehearsed: {why}", step.step);
                (exchange.record)(Exchanged::Note(note))?;
                self.inner.decide(step, exchange)
            }
            (None, None) => self.best(step, exchange),
        };
        let took = std::mem::take(&mut self.twins.took);
        (exchange.record)(Exchanged::Rehearsed(&self.twins.line, took))?;
        decided
    }
}

#[cfg(test)]
#[path = "tests/rehearsing.rs"]
mod tests;
