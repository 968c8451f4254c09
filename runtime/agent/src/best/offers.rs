//! The actions that a state offers and the task's checks accept, the most promising first.
//!
//! In: the scene of a state. Out: [`Offers`]. Each action is judged as a rollout judges it. Actions that move the cloth
//! alike are offered once.

use super::Choice;
use super::aim::{ExpertGrip, off_m};
use crate::action::{Action, MOST_COMBINATIONS, combinations};
use crate::error::RunError;
use crate::policy::Ground;
use fab_base::chance::Chance;
use fab_base::interrupt::Interrupt;
use fab_program::facts::Facts;
use fab_program::verify::{Strictness, Verdict};
use fab_program::{Choices, Proposal, space};
use fab_world::WorldError;
use std::collections::BTreeSet;

/// How many of more combinations are drawn.
const DRAWN: usize = 2_000;

/// What can be done in a state.
#[derive(Debug, Default)]
pub(super) struct Offers {
    /// The most promising first.
    pub choices: Vec<Choice>,
    /// Whether these are only some of what is offered.
    pub are_drawn: bool,
}

impl Offers {
    /// Lists what can be done in a state.
    ///
    /// - `experts`: what the experts would do; they rank the actions.
    ///
    /// Fails if a check cannot be evaluated, and on an interrupt.
    pub fn of(
        at: Ground<'_>,
        facts: Facts<'_>,
        experts: &[ExpertGrip],
        mut chance: Chance,
        interrupt: &Interrupt,
    ) -> Result<Offers, RunError> {
        let relaxed = &at.program.verify.relaxed;
        let (proposals, are_drawn) = proposals(at, &mut chance);
        let mut seen = BTreeSet::new();
        let mut ranked = Vec::new();
        for proposal in proposals {
            if interrupt.is_raised() {
                return Err(WorldError::Interrupted.into());
            }
            let is_accepted = |strictness| {
                let verdict = at.verdict(facts, &proposal, strictness);
                verdict.map(|verdict| verdict == Verdict::Accept)
            };
            let without = if is_accepted(Strictness::Full)? {
                Vec::new()
            } else if !relaxed.is_empty() && is_accepted(Strictness::Relaxed)? {
                relaxed.clone()
            } else {
                continue;
            };
            let action = Action::lower(at.program, &proposal, at.scene, at.observation);
            let Some(action) = action else {
                continue;
            };
            if seen.insert(format!("{:?}", action.grip)) {
                let choice = Choice {
                    proposal,
                    without,
                    action,
                };
                ranked.push((off_m(experts, &choice.action.grip), choice));
            }
        }
        if experts.is_empty() {
            // Nothing ranks them: any order, but a seeded one, so that the first few are a fair sample.
            for index in (1..ranked.len()).rev() {
                ranked.swap(index, chance.below(index + 1));
            }
        } else {
            ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        Ok(Offers {
            choices: ranked.into_iter().map(|(_, choice)| choice).collect(),
            are_drawn,
        })
    }
}

/// Combines the choices of all fields; of too many combinations, or of the pixels of a mask, some are drawn. Returns whether
/// they were.
fn proposals(at: Ground<'_>, chance: &mut Chance) -> (Vec<Proposal>, bool) {
    let mut fields = at.program.actions.iter();
    if !fields.any(|field| matches!(field.choices, Choices::Region { .. })) {
        let all = combinations(at.program, |field| space::choices(field, at.scene));
        if all.len() <= MOST_COMBINATIONS {
            return (all.collect(), false);
        }
    }
    // A number below an in-memory count fits in `usize`. Equal grips are offered once.
    let mut below = |count: u64| chance.below(count as usize) as u64;
    let drawn = (0..DRAWN).filter_map(|_| space::sample(at.program, at.scene, &mut below));
    (drawn.collect(), true)
}
