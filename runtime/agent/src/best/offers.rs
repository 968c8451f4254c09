//! The actions that a state offers and the task's checks accept, the most promising first.
//!
//! In: the scene of a state. Out: [`Offers`]. Each action is judged as a rollout judges it. Actions that move the cloth
//! alike are offered once.

use super::aim::{ExpertGrip, off_m};
use super::{BestError, Choice};
use crate::action::{Action, combination, combinations};
use crate::policy::Ground;
use fab_base::chance::Chance;
use fab_base::interrupt::Interrupt;
use fab_program::facts::Facts;
use fab_program::scene::SceneView;
use fab_program::verify::{Strictness, Verdict};
use fab_program::{ActionField, Choices, Proposal, Value, space};
use fab_world::WorldError;
use std::collections::BTreeSet;

/// The most combinations of a step's choices that are listed; of more, as many are drawn.
const MOST_COMBINATIONS: usize = 20_000;

/// How many pixels of a mask are drawn.
const MOST_PIXELS: usize = 64;

/// What can be done in a state.
#[derive(Debug, Default)]
pub(super) struct Offers {
    /// The most promising first.
    pub choices: Vec<Choice>,
    /// What was only drawn from.
    pub sampled: Vec<String>,
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
    ) -> Result<Offers, BestError> {
        let mut sampled = Vec::new();
        let mut seen = BTreeSet::new();
        let mut ranked = Vec::new();
        for proposal in proposals(at, &mut chance, &mut sampled) {
            if interrupt.is_raised() {
                return Err(WorldError::Interrupted.into());
            }
            let Some(without) = dropped(at, facts, &proposal)? else {
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
            sampled,
        })
    }
}

/// Returns the checks that must be dropped to accept an action; `None` if it is refused for good.
fn dropped(
    at: Ground<'_>,
    facts: Facts<'_>,
    proposal: &Proposal,
) -> Result<Option<Vec<String>>, BestError> {
    let relaxed = &at.program.verify.relaxed;
    let is_accepted = |strictness| {
        let verdict = at.verdict(facts, proposal, strictness);
        verdict.map(|verdict| verdict == Verdict::Accept)
    };
    if is_accepted(Strictness::Full)? {
        Ok(Some(Vec::new()))
    } else if !relaxed.is_empty() && is_accepted(Strictness::Relaxed)? {
        Ok(Some(relaxed.clone()))
    } else {
        Ok(None)
    }
}

/// Combines the choices of all fields; of too many combinations, some are drawn.
fn proposals(at: Ground<'_>, chance: &mut Chance, sampled: &mut Vec<String>) -> Vec<Proposal> {
    let fields = at.program.actions.iter().map(|field| {
        let values = values_of(field, at.scene, chance, sampled);
        (field.name.clone(), values)
    });
    let fields: Vec<_> = fields.collect();
    let all = combinations(&fields);
    if all.len() <= MOST_COMBINATIONS {
        return all.collect();
    }
    let names: Vec<&str> = fields.iter().map(|(name, _)| name.as_str()).collect();
    sampled.push(names.join(" x "));
    // Twice the same is no loss: equal grips are offered once.
    let draw = |_| combination(&fields, (chance.fraction() * all.len() as f64) as usize);
    (0..MOST_COMBINATIONS).map(draw).collect()
}

/// Returns the choices of a field; of a mask, some pixels.
fn values_of(
    field: &ActionField,
    scene: &dyn SceneView,
    chance: &mut Chance,
    sampled: &mut Vec<String>,
) -> Vec<Value> {
    let Choices::Region { mask } = &field.choices else {
        return space::choices(field, scene);
    };
    // An area is a whole number far below 2^53.
    let n_pixels = scene.area_px(mask).unwrap_or_default() as usize;
    let numbers: BTreeSet<usize> = if n_pixels > MOST_PIXELS {
        sampled.push(space::any_of(mask));
        (0..MOST_PIXELS).map(|_| chance.below(n_pixels)).collect()
    } else {
        (0..n_pixels).collect()
    };
    let pixels = numbers.into_iter();
    let pixels = pixels.filter_map(|number| scene.region_pixel(mask, number as u64));
    pixels.map(Value::Point).collect()
}
