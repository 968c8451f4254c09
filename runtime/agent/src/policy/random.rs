//! The policy that draws from the declared action space, without a prompt.
//!
//! It is the paper's random policy, a baseline for others. Seed, start, repetition, action and attempt determine the
//! draw.

use super::proposing::{Source, stop, until_accepted};
use super::{Decision, Description, Exchange, Kind, Policy, RunError, StepView};
use crate::outcome::Outcome;
use fab_base::chance::Chance;
use fab_program::space;

/// Draws each field of an action from what is offered.
#[derive(Clone, Copy, Debug)]
pub struct Random {
    /// Determines all draws.
    pub seed: u64,
}

impl Policy for Random {
    fn description(&self) -> Description {
        Description::new(Kind::Random, format!("random policy, seed {}", self.seed))
    }

    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, RunError> {
        let mut chance = Chance::of(&format!(
            "random policy {} {} {} {}",
            self.seed, step.start, step.repetition, step.number
        ));
        until_accepted(step, exchange, &mut |_, _| {
            // A number below an in-memory count fits in `usize`.
            let mut below = |count: u64| chance.below(count as usize) as u64;
            let sampled = space::sample(step.program, step.scene, &mut below);
            let nothing = "a field has nothing to choose from";
            let nothing = || stop(Outcome::NoCandidates, nothing);
            Ok((Source::default(), sampled.map_or_else(nothing, Ok)))
        })
    }
}
