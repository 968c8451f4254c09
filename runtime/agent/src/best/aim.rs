//! What a search aims at: the measure of a final state, and how promising a state is on the way there.
//!
//! In: particle positions. Out: losses, of which lower is better. On the way, a fold is compared with the states
//! of the experts after as many folds; the least distance counts.

use super::{BestError, Search};
use fab_program::{Comparison, Fold, Goal, Metric, Program, Sequence};
use fab_world::expert::{self, Sequences};
use fab_world::metrics;
use fab_world::start::Start;
use fab_world::{Grip, WorldError, WorldPoint};

/// What results are measured by: the goal's measure, or the distance to the experts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measure {
    /// What is measured.
    pub metric: Metric,
    /// Whether a larger measure is better.
    pub more_is_better: bool,
}

impl Measure {
    /// Returns what the results of a task are measured by.
    ///
    /// Fails if the task says nowhere what is better.
    pub fn of(program: &Program) -> Result<Measure, BestError> {
        let goal = program.goal.as_ref();
        let is_more = |goal: &Goal| matches!(goal.is, Comparison::Greater | Comparison::AtLeast);
        let measure = Measure {
            metric: goal.map_or(Metric::ParticleDistance, |goal| goal.metric),
            more_is_better: goal.is_some_and(is_more),
        };
        if measure.experts_lead() && program.experts.is_empty() {
            return Err(BestError::Aimless {
                task: program.title(),
            });
        }
        Ok(measure)
    }

    /// Returns a number that is lower for a better measure.
    pub fn loss(self, value: f64) -> f64 {
        if self.more_is_better { -value } else { value }
    }

    pub(super) fn experts_lead(self) -> bool {
        self.metric == Metric::ParticleDistance
    }
}

/// Where an expert would pick and place, and how far the cloth is from the expert's, metres.
pub(super) type ExpertGrip = (f64, Grip);

/// The aim of one search.
#[derive(Debug)]
pub struct Aim<'a> {
    /// What is measured.
    pub measure: Measure,
    start: &'a Start,
    goal: Option<&'a Goal>,
    coverage_at_start: Option<f64>,
    sequences: &'a [Sequence],
    /// For each sequence the particles after 0, 1, … folds.
    states: Vec<Vec<Vec<[f32; 3]>>>,
}

impl<'a> Aim<'a> {
    /// Finds what is measured, and simulates the experts' states that are not cached yet.
    ///
    /// Fails if the task says nowhere what is better, the start gives nothing to measure, or a fold cannot be executed.
    pub fn of(search: &Search<'a>) -> Result<Aim<'a>, BestError> {
        let (program, start) = (search.program, search.start);
        let measure = Measure::of(program)?;
        let sequences = if measure.experts_lead() {
            program.experts.as_slice()
        } else {
            &[]
        };
        let aim = Aim {
            measure,
            start,
            goal: program.goal.as_ref(),
            coverage_at_start: metrics::coverage(&start.positions, &start.grid),
            states: states(search, sequences)?,
            sequences,
        };
        aim.value(&start.positions)?;
        Ok(aim)
    }

    /// Measures a state as the rollout's last one.
    ///
    /// - `positions`: one for each particle, world frame, metres.
    ///
    /// Fails if it cannot be measured from this start.
    pub fn value(&self, positions: &[[f32; 3]]) -> Result<f64, BestError> {
        let coverage = metrics::coverage(positions, &self.start.grid);
        let value = match self.measure.metric {
            Metric::Coverage => coverage,
            Metric::NormalizedImprovement => coverage
                .zip(self.coverage_at_start)
                .and_then(|(now, before)| metrics::normalized_improvement(now, before)),
            Metric::ParticleDistance => {
                let ends = self.states.iter().filter_map(|states| states.last());
                let all = ends.filter_map(|end| metrics::mean_particle_distance_m(positions, end));
                all.min_by(f64::total_cmp)
            }
        };
        value.ok_or_else(|| BestError::Unmeasured {
            start: self.start.name.clone(),
            why: match self.measure.metric {
                Metric::NormalizedImprovement => {
                    "it covers as much as the flat cloth, so that nothing can be gained"
                }
                _ => "its particles are not those of the experts",
            },
        })
    }

    /// Returns how far a state is from the nearest state of an expert after `folds` folds, metres; its loss where no
    /// expert leads.
    pub(super) fn behind(&self, positions: &[[f32; 3]], folds: u32) -> Result<f64, BestError> {
        let distances = self.states.iter().filter_map(|states| {
            let state = states.get(folds as usize).or(states.last())?;
            metrics::mean_particle_distance_m(positions, state)
        });
        match distances.min_by(f64::total_cmp) {
            Some(least) => Ok(least),
            None => Ok(self.measure.loss(self.value(positions)?)),
        }
    }

    /// Returns what the experts would do in a state as the fold after `folds` folds.
    pub(super) fn expert_grips(&self, positions: &[[f32; 3]], folds: u32) -> Vec<ExpertGrip> {
        let all = self.sequences.iter().zip(&self.states);
        let all = all.filter_map(|(sequence, states)| {
            let fold = sequence.folds.get(folds as usize)?;
            let state = states.get(folds as usize)?;
            let off_m = metrics::mean_particle_distance_m(positions, state)?;
            let grip = expert::grip_of(fold, self.start, positions)?;
            Some((off_m, grip))
        });
        all.collect()
    }

    /// Returns whether a state ends a rollout, because its goal is judged after each step and met.
    pub(super) fn is_reached(&self, value: f64) -> bool {
        let judged = self.goal.filter(|goal| goal.metric.is_judged_each_step());
        judged.is_some_and(|goal| goal.is_met(value))
    }
}

/// Returns how far a grip is from what the nearest expert would do, metres; 0 where no expert leads.
pub(super) fn off_m(experts: &[ExpertGrip], grip: &Grip) -> f64 {
    let apart = |a: WorldPoint, b: WorldPoint| (a.x - b.x).hypot(a.y - b.y);
    let all = experts.iter().map(|(off_m, expert)| {
        off_m + apart(expert.pick, grip.pick) + apart(expert.place, grip.place)
    });
    all.reduce(f64::min).unwrap_or_default()
}

/// Simulates the sequences fold by fold; equal beginnings once.
fn states(
    search: &Search<'_>,
    sequences: &[Sequence],
) -> Result<Vec<Vec<Vec<[f32; 3]>>>, WorldError> {
    let mut beginnings: Vec<Sequence> = Vec::new();
    for sequence in sequences {
        for folds in 1..=sequence.folds.len() {
            let folds = sequence.folds[..folds].to_vec();
            let beginning = Sequence { folds };
            if !beginnings.contains(&beginning) {
                beginnings.push(beginning);
            }
        }
    }
    let ends = expert::ends(
        Sequences {
            folds: &beginnings,
            manner: search.program.manner,
        },
        search.start,
        search.make_expert_world,
        search.cache,
        search.interrupt,
        &mut |_| {},
    )?;
    let after = |folds: &[Fold]| {
        let end = ends.ends.iter();
        let mut end = end.filter(|end| beginnings[end.sequence].folds == folds);
        end.next()
            .map_or(search.start.positions.clone(), |end| end.positions.clone())
    };
    let states = sequences.iter().map(|sequence| {
        let folds = 0..=sequence.folds.len();
        folds.map(|folds| after(&sequence.folds[..folds])).collect()
    });
    Ok(states.collect())
}
