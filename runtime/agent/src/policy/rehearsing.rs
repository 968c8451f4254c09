//! A policy that decides with twins at hand: any policy, and the twins of its rollout.
//!
//! In: each step, and what the world has done since the one before. Out: of the inner policy's answers the one that does
//! best on the twins; or a stop, where nothing may move because twins and camera disagree. The first answer is what the
//! inner policy decides by itself. Further ones are asked for as the task says: independent ones, then revisions of the
//! best. A policy that asks no model has one answer, which is not tried.

use super::{
    Accepted, Again, Decision, Description, Exchange, Exchanged, Kind, Policy, PolicyError,
    StepView,
};
use crate::action::Action;
use crate::outcome::Outcome;
use crate::twins::{Interrupted, Twins};
use fab_program::{Program, Proposal};
use fab_world::Motion;

/// By how much a measure must differ to decide anything: silhouettes are compared to about a hundredth.
const NOTICEABLE: f64 = 0.01;

/// A policy around another one.
pub struct Rehearsing<'p> {
    inner: Box<dyn Policy + 'p>,
    twins: Twins,
}

/// An accepted answer, and what would come of it.
struct Candidate {
    /// Which of the policy's answers to the step it is, from 0.
    answer: usize,
    grips: Vec<Proposal>,
    accepted: Accepted,
    /// `None` if the answer leads nowhere, which the rollout reports if it is taken.
    motion: Option<Motion>,
    /// The mean over the twins; `None` if the task declares no measure, or the answer could not be tried.
    measure: Option<f64>,
}

impl<'p> Rehearsing<'p> {
    /// Lets a policy try its answers on twins.
    pub fn new(inner: Box<dyn Policy + 'p>, twins: Twins) -> Rehearsing<'p> {
        Rehearsing { inner, twins }
    }

    /// Decides with twins that can be trusted.
    fn decide_with_twins(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, PolicyError> {
        let first = self.inner.decide(step, exchange)?;
        let mut further = 0;
        let record = &mut *exchange.record;
        let mut exchange = Exchange {
            asking: exchange.asking,
            record: &mut |exchanged| {
                further += u32::from(matches!(exchanged, Exchanged::Attempt(_)));
                record(exchanged)
            },
            interrupt: exchange.interrupt,
        };
        let decided = match self.best(step, first.clone(), &mut exchange)? {
            Ok(Some(best)) => Decision::Act {
                grips: best.grips,
                accepted: best.accepted,
            },
            Ok(None) => first,
            Err(Interrupted) => step.without_answer(Outcome::Interrupted),
        };
        let line = &mut self.twins.line;
        line.calls = further;
        if let Decision::Act { accepted, .. } = &decided {
            line.chosen = Some(accepted.attempt);
        }
        Ok(decided)
    }

    /// Asks for the answers that the task declares, and returns the best; `None` if the first decision stands.
    fn best(
        &mut self,
        step: &StepView<'_>,
        first: Decision,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Result<Option<Candidate>, Interrupted>, PolicyError> {
        let rehearsal = self.twins.rehearsal.clone();
        let stages = &step.program.stages;
        let stage = stages.iter().find(|stage| stage.name == rehearsal.stage);
        let count = rehearsal.choose.and(stage).map_or(1, |it| it.candidates());
        let mut best: Option<Candidate> = None;
        let (mut next, mut unusable) = (Some(first), 0);
        for answer in 0..count as usize {
            if answer > 0 {
                next = self.inner.again(step, exchange, Again::Independent)?;
            }
            match next.take() {
                Some(Decision::Act { grips, accepted }) => {
                    let candidate = match self.tried(step, answer, (grips, accepted), exchange) {
                        Ok(candidate) => candidate,
                        Err(interrupted) => return Ok(Err(interrupted)),
                    };
                    if best.as_ref().is_none_or(|best| candidate.is_better(best)) {
                        best = Some(candidate);
                    }
                }
                // Only the policy's own faults leave the others a chance.
                Some(
                    Decision::Skip(_)
                    | Decision::Stop {
                        outcome: Outcome::AttemptsExhausted | Outcome::MalformedReply,
                        ..
                    },
                ) => unusable += 1,
                Some(Decision::Stop {
                    outcome: Outcome::Interrupted,
                    ..
                }) => return Ok(Err(Interrupted)),
                // Without rehearsal it would not have been asked, so the answers that came still count.
                Some(Decision::Stop { why, .. }) if answer > 0 => {
                    self.twins.fall_short(format!(
                        "candidate {} of {count} was not answered, and no more were asked for: {why}",
                        answer + 1
                    ));
                    break;
                }
                Some(Decision::Stop { .. }) => return Ok(Ok(None)),
                None => break,
            }
        }
        if unusable > 0 && best.is_some() {
            self.twins.fall_short(format!(
                "{unusable} of {count} candidates were not usable after all their attempts"
            ));
        }
        match best {
            Some(best) => Ok(self
                .revised(best, rehearsal.revisions, step, exchange)?
                .map(Some)),
            None => Ok(Ok(None)),
        }
    }

    /// Shows the policy what would come of its answer, as often as the task says, and takes on what it answers then.
    ///
    /// An answer that does not come, cannot be read, is refused, or is measured as worse leaves the one before it.
    fn revised(
        &mut self,
        mut taken: Candidate,
        revisions: u32,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Result<Candidate, Interrupted>, PolicyError> {
        let (mut highest, answer) = (taken.measure, taken.answer);
        for number in 1..=revisions {
            let motion = taken.motion.as_ref();
            let Some(predicted) = motion.and_then(|motion| self.twins.picture(motion)) else {
                break;
            };
            let again = Again::Revised { answer, predicted };
            let candidate = match self.inner.again(step, exchange, again)? {
                Some(Decision::Act { grips, accepted }) if grips != taken.grips => {
                    self.tried(step, answer, (grips, accepted), exchange)
                }
                Some(Decision::Stop {
                    outcome: Outcome::Interrupted,
                    ..
                }) => Err(Interrupted),
                Some(Decision::Stop { outcome, why })
                    if !matches!(
                        outcome,
                        Outcome::AttemptsExhausted | Outcome::MalformedReply
                    ) =>
                {
                    let why = format!("revision {number} was not answered: {why}");
                    self.twins.fall_short(why);
                    break;
                }
                _ => break,
            };
            let candidate = match candidate {
                Ok(candidate) => candidate,
                Err(interrupted) => return Ok(Err(interrupted)),
            };
            let motion = candidate.motion.as_ref();
            let was_tried = motion.is_some_and(|motion| self.twins.picture(motion).is_some());
            if !was_tried || !admits(&mut highest, candidate.measure) {
                break;
            }
            taken = candidate;
        }
        Ok(Ok(taken))
    }

    /// Tries an answer on the twins; one that cannot be tried has no measure.
    fn tried(
        &mut self,
        step: &StepView<'_>,
        answer: usize,
        (grips, accepted): (Vec<Proposal>, Accepted),
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Candidate, Interrupted> {
        let lowered = grips.iter().map(|proposal| {
            let action = Action::lower(step.program, proposal, step.scene, step.observation)?;
            Some(action.grip)
        });
        let motion = lowered.collect::<Option<_>>().map(|grips| Motion { grips });
        let measure = match &motion {
            Some(motion) => self
                .twins
                .try_motion(accepted.attempt, motion, exchange.interrupt)?,
            None => None,
        };
        Ok(Candidate {
            answer,
            grips,
            accepted,
            motion,
            measure,
        })
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

    fn prepare(&self, program: &Program) -> Result<Option<String>, PolicyError> {
        self.inner.prepare(program)
    }

    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, PolicyError> {
        let looked = self.twins.look(step, exchange.interrupt);
        if let Err(Interrupted) = looked {
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
            (None, None) if self.description().kind == Kind::Prompted => {
                self.decide_with_twins(step, exchange)
            }
            (None, None) => self.inner.decide(step, exchange),
        };
        let took = std::mem::take(&mut self.twins.took);
        (exchange.record)(Exchanged::Rehearsed(&self.twins.line, took))?;
        decided
    }
}

#[cfg(test)]
#[path = "tests/rehearsing.rs"]
mod tests;
