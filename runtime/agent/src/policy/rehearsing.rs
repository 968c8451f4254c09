//! A policy that decides with twins at hand: any policy, and the twins of its rollout.
//!
//! In: each step, and what the world has done since the one before. Out: the inner policy's decision, for which it may
//! try actions on the twins; or a stop, where nothing may move because twins and camera disagree.

use super::{Decision, Description, Exchange, Exchanged, Policy, PolicyError, StepView};
use crate::outcome::Outcome;
use crate::twins::{Interrupted, Twins};
use fab_program::Program;

/// A policy around another one.
pub struct Rehearsing<'p> {
    inner: Box<dyn Policy + 'p>,
    twins: Twins,
}

impl<'p> Rehearsing<'p> {
    /// Lets a policy try its answers on twins.
    pub fn new(inner: Box<dyn Policy + 'p>, twins: Twins) -> Rehearsing<'p> {
        Rehearsing { inner, twins }
    }
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
        let twins = &mut self.twins;
        if let Some(executed) = step.executed {
            twins.follow(executed.clone());
        }
        let cloth = step.scene.cloth();
        let looked = twins.look(step.step, step.observation, cloth, exchange.interrupt);
        if let Err(Interrupted) = looked {
            return Ok(Decision::Stop {
                outcome: Outcome::Interrupted,
                why: "interrupted".to_owned(),
            });
        }
        let refusal = twins.refusal();
        if let (Some(why), None) = (twins.aside(), &refusal) {
            let note = format!("step {} is not rehearsed: {why}", step.step);
            (exchange.record)(Exchanged::Note(note))?;
        }
        let decided = match refusal {
            Some(why) => Ok(Decision::Stop {
                outcome: Outcome::RehearsalRefused,
                why,
            }),
            None => {
                let mut exchange = Exchange {
                    asking: exchange.asking,
                    record: exchange.record,
                    interrupt: exchange.interrupt,
                    twins: Some(&mut *twins),
                };
                self.inner.decide(step, &mut exchange)
            }
        };
        let took = twins.take_time();
        (exchange.record)(Exchanged::Rehearsed(twins.line(), took))?;
        decided
    }
}
