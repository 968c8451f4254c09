//! The actions that a state offers and the task's checks accept, the most promising first.
//!
//! In: the scene of a state. Out: [`Offers`]. Each action is judged as a rollout judges it. Actions that move the cloth
//! alike are offered once.

use super::aim::{ExpertGrip, off_m};
use super::{BestError, Choice, Search};
use crate::action::Action;
use crate::scene::Scene;
use fab_base::chance::Chance;
use fab_picture::observation::Observation;
use fab_program::facts::Facts;
use fab_program::scene::SceneView;
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::{ActionField, Choices, Proposal, Value, space};
use fab_world::{World, WorldError};
use std::collections::BTreeSet;

/// The most combinations of a step's choices that are listed; of more, as many are drawn.
const MOST_COMBINATIONS: u64 = 20_000;

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

/// A state before an action.
pub(super) struct Situation<'a> {
    pub search: &'a Search<'a>,
    pub world: &'a dyn World,
    pub observation: &'a Observation,
    pub facts: Facts<'a>,
    pub scene: &'a Scene,
}

impl Offers {
    /// Lists what can be done in a state.
    ///
    /// - `experts`: what the experts would do; they rank the actions.
    ///
    /// Fails if a check cannot be evaluated, and on an interrupt.
    pub fn of(
        at: &Situation<'_>,
        experts: &[ExpertGrip],
        mut chance: Chance,
    ) -> Result<Offers, BestError> {
        let mut sampled = Vec::new();
        let mut seen = BTreeSet::new();
        let mut ranked = Vec::new();
        for proposal in proposals(at, &mut chance, &mut sampled) {
            if at.search.interrupt.is_raised() {
                return Err(WorldError::Interrupted.into());
            }
            let Some(without) = at.accepts(&proposal)? else {
                continue;
            };
            let Some(action) = at.executable(&proposal) else {
                continue;
            };
            if seen.insert(format!("{:?}", action.grip)) {
                let off_m = off_m(experts, &action.grip);
                let choice = Choice {
                    proposal,
                    without,
                    action,
                };
                ranked.push((off_m, choice));
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

impl Situation<'_> {
    /// Returns the checks that must be dropped to accept an action; `None` if it is refused for good.
    fn accepts(&self, proposal: &Proposal) -> Result<Option<Vec<String>>, BestError> {
        let program = self.search.program;
        let judge = |strictness| verify::verdict(program, self.facts, proposal, strictness);
        let relaxed = &program.verify.relaxed;
        if judge(Strictness::Full)? == Verdict::Accept {
            Ok(Some(Vec::new()))
        } else if !relaxed.is_empty() && judge(Strictness::Relaxed)? == Verdict::Accept {
            Ok(Some(relaxed.clone()))
        } else {
            Ok(None)
        }
    }

    /// Returns what an action means on the table; `None` if the world cannot execute it.
    fn executable(&self, proposal: &Proposal) -> Option<Action> {
        let program = self.search.program;
        let action = Action::lower(program, proposal, self.scene, self.observation)?;
        let grip = action.grip;
        let ends = [&grip.pick, &grip.place];
        let is_beyond = |point| self.world.out_of_reach(point).is_some();
        let is_refused =
            ends.into_iter().any(is_beyond) || self.world.refuses(&grip.into()).is_some();
        (!is_refused).then_some(action)
    }
}

/// Combines the choices of all fields.
fn proposals(at: &Situation<'_>, chance: &mut Chance, sampled: &mut Vec<String>) -> Vec<Proposal> {
    let fields = &at.search.program.actions;
    let values = fields.iter();
    let values = values.map(|field| values_of(field, at.scene, chance, sampled));
    let values: Vec<Vec<Value>> = values.collect();
    let counts = values.iter().map(|values| values.len() as u64);
    let all = counts.fold(1u64, u64::saturating_mul);
    let numbers: Vec<u64> = if all > MOST_COMBINATIONS {
        let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
        sampled.push(names.join(" x "));
        // Twice the same is no loss: equal grips are offered once.
        let draw = |_| (chance.fraction() * all as f64) as u64;
        (0..MOST_COMBINATIONS).map(draw).collect()
    } else {
        (0..all).collect()
    };
    let proposal = |mut number: u64| {
        let chosen = fields.iter().zip(&values).map(|(field, values)| {
            let count = values.len() as u64;
            let value = values[(number % count) as usize].clone();
            number /= count;
            (field.name.clone(), value)
        });
        Proposal {
            fields: chosen.collect(),
        }
    };
    numbers.into_iter().map(proposal).collect()
}

/// Returns the choices of a field; of a mask, some pixels.
fn values_of(
    field: &ActionField,
    scene: &Scene,
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
