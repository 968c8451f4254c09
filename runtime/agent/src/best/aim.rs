//! What a search aims at: the measure of a final state, and how promising a state is on the way there.
//!
//! In: particle positions. Out: numbers of which the lower is the better. On the way, a fold is compared with the states
//! of the experts after as many folds; the least distance counts.

use super::{BestError, Measure, Search};
use fab_program::{Metric, Sequence};
use fab_world::expert::{self, Sequences};
use fab_world::metrics;
use fab_world::start::Start;
use fab_world::{Grip, World, WorldError, WorldPoint};
use std::collections::BTreeMap;

/// The aim of one search.
#[derive(Debug)]
pub struct Aim {
    /// What is measured.
    pub measure: Measure,
    start: Start,
    coverage_at_start: Option<f64>,
    sequences: Vec<Sequence>,
    /// For each sequence the states after 0, 1, … folds.
    states: Vec<Vec<Vec<[f32; 3]>>>,
}

impl Aim {
    /// Finds what is measured, and simulates the experts' states that are not stored yet.
    pub fn of(search: &Search<'_>) -> Result<Aim, BestError> {
        let program = search.program;
        let measure = Measure::of(program)?;
        let sequences = match measure.experts_lead() {
            true => program.experts.clone(),
            false => Vec::new(),
        };
        Ok(Aim {
            measure,
            start: search.start.clone(),
            coverage_at_start: metrics::coverage(&search.start.positions, &search.start.grid),
            states: states(search, &sequences)?,
            sequences,
        })
    }

    /// Measures a state as the rollout's last one; `None` if it cannot be measured.
    pub fn value(&self, positions: &[[f32; 3]]) -> Option<f64> {
        let coverage = || metrics::coverage(positions, &self.start.grid);
        match self.measure.metric {
            Metric::Coverage => coverage(),
            Metric::NormalizedImprovement => {
                metrics::normalized_improvement(coverage()?, self.coverage_at_start?)
            }
            Metric::ParticleDistance => {
                let ends = self.states.iter().filter_map(|states| states.last());
                let all = ends.filter_map(|end| metrics::mean_particle_distance_m(positions, end));
                all.min_by(f64::total_cmp)
            }
        }
    }

    /// Returns how far a state is from the nearest state of an expert after `folds` folds, metres; its loss where no
    /// expert leads.
    pub(super) fn behind(&self, positions: &[[f32; 3]], folds: u32) -> Option<f64> {
        let distances = self.states.iter().filter_map(|states| {
            let state = states.get(folds as usize).or(states.last())?;
            metrics::mean_particle_distance_m(positions, state)
        });
        match distances.min_by(f64::total_cmp) {
            Some(least) => Some(least),
            None => Some(self.measure.loss(self.value(positions)?)),
        }
    }

    /// Returns where the experts would pick and place in a state as the fold after `folds` folds, each with how far the
    /// state is from theirs, metres.
    pub(super) fn wanted(&self, positions: &[[f32; 3]], folds: u32) -> Vec<(f64, [WorldPoint; 2])> {
        let all = self.sequences.iter().zip(&self.states);
        let all = all.filter_map(|(sequence, states)| {
            let fold = sequence.folds.get(folds as usize)?;
            let state = states.get(folds as usize)?;
            let off = metrics::mean_particle_distance_m(positions, state)?;
            let grip = expert::grip_of(fold, &self.start, positions)?;
            Some((off, [grip.pick, grip.place]))
        });
        all.collect()
    }

    /// Returns how far a grip is from what the nearest expert would do, metres; 0 where no expert says.
    ///
    /// - `wanted`: as [`Aim::wanted`] returns it.
    pub(super) fn off(wanted: &[(f64, [WorldPoint; 2])], grip: &Grip) -> f64 {
        let apart = |a: WorldPoint, b: WorldPoint| (a.x - b.x).hypot(a.y - b.y);
        let all = wanted
            .iter()
            .map(|(off, [pick, place])| off + apart(*pick, grip.pick) + apart(*place, grip.place));
        all.reduce(f64::min).unwrap_or_default()
    }

    /// Returns whether a state ends a rollout, because its goal is judged after each step and met.
    pub(super) fn ends(&self, search: &Search<'_>, value: f64) -> bool {
        let goal = search.program.goal.as_ref();
        goal.is_some_and(|goal| goal.metric.is_judged_each_step() && goal.is_met(value))
    }
}

/// Simulates the sequences fold by fold; equal beginnings once.
fn states(
    search: &Search<'_>,
    sequences: &[Sequence],
) -> Result<Vec<Vec<Vec<[f32; 3]>>>, WorldError> {
    let mut beginnings: Vec<Sequence> = Vec::new();
    for sequence in sequences {
        for folds in 1..=sequence.folds.len() {
            let beginning = Sequence {
                folds: sequence.folds[..folds].to_vec(),
            };
            if !beginnings.contains(&beginning) {
                beginnings.push(beginning);
            }
        }
    }
    if beginnings.is_empty() {
        return Ok(Vec::new());
    }
    let make_world =
        || -> Result<Box<dyn World>, WorldError> { Ok(Box::new((search.make_world)()?)) };
    let ends = expert::ends(
        Sequences {
            folds: &beginnings,
            manner: search.program.manner,
        },
        search.start,
        &make_world,
        search.cache,
        search.interrupt,
        &mut |_| {},
    )?;
    let known: BTreeMap<usize, Vec<[f32; 3]>> = ends
        .ends
        .into_iter()
        .map(|end| (end.sequence, end.positions))
        .collect();
    let state = |folds: &[fab_program::Fold]| match folds {
        [] => Some(search.start.positions.clone()),
        _ => {
            let index = beginnings.iter().position(|it| it.folds == folds)?;
            known.get(&index).cloned()
        }
    };
    let states = sequences.iter().map(|sequence| {
        let all = (0..=sequence.folds.len()).map(|folds| state(&sequence.folds[..folds]));
        all.collect::<Option<Vec<_>>>().unwrap_or_default()
    });
    Ok(states.collect())
}
