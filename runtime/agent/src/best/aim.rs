//! What a search aims at: the measure of a final state, and how promising a state is on the way there.
//!
//! In: particle positions. Out: losses, of which lower is better. On the way, a fold is compared with the states
//! of the experts after as many folds; the least distance counts.

use crate::error::RunError;
use crate::rollout::Job;
use fab_program::{Comparison, Goal, Metric, Sequence};
use fab_world::expert::{self, Sequences};
use fab_world::metrics::{coverage, mean_particle_distance_m, normalized_improvement};
use fab_world::start::Start;
use fab_world::{Grip, WorldError, WorldPoint};

/// Where an expert would pick and place, and how far the cloth is from the expert's, metres.
pub(super) type ExpertGrip = (f64, Grip);

/// An expert sequence with the particles after 0, 1, … folds.
type Expert<'a> = (&'a Sequence, Vec<Vec<[f32; 3]>>);

/// The aim of one job.
#[derive(Debug)]
pub struct Aim<'a> {
    /// What results are measured by: the goal's measure, or the distance to the experts.
    pub metric: Metric,
    start: &'a Start,
    goal: Option<&'a Goal>,
    /// None if the measure is another.
    experts: Vec<Expert<'a>>,
}

impl<'a> Aim<'a> {
    /// Finds what is measured, and simulates the experts' states that are not cached yet.
    ///
    /// Fails if the task says nowhere what is better, actions cannot be tried in the world, the start gives nothing to
    /// measure, or a fold cannot be executed; on an interrupt, with [`WorldError::Interrupted`].
    pub fn of(job: &Job<'a>) -> Result<Aim<'a>, RunError> {
        let mut world = (job.make_world)()?;
        world.reset(job.start)?;
        if !world.repeats() || world.particles().is_none() {
            return Err(RunError::Failed(format!(
                "the world `{}` cannot lay a start again exactly, or does not know where the cloth's particles are, so actions cannot be tried in it: search in `sim`, or in a program that does both",
                world.name()
            )));
        }
        let goal = job.program.goal.as_ref();
        let metric = goal.map_or(Metric::ParticleDistance, |goal| goal.metric);
        let experts = match metric {
            Metric::ParticleDistance if job.program.experts.is_empty() => {
                return Err(RunError::Unfit(format!(
                    "`{}` declares no `goal`, no `experts` and no demonstration, so no result is better than another: declare one of them",
                    job.program.title()
                )));
            }
            Metric::ParticleDistance => experts(job)?,
            Metric::Coverage | Metric::NormalizedImprovement => Vec::new(),
        };
        let aim = Aim {
            metric,
            start: job.start,
            goal,
            experts,
        };
        aim.value(&job.start.positions)?;
        Ok(aim)
    }

    /// Returns a number that is lower for a better measure.
    pub fn loss(&self, value: f64) -> f64 {
        match self.goal.map(|goal| goal.is) {
            Some(Comparison::Greater | Comparison::AtLeast) => -value,
            _ => value,
        }
    }

    /// Measures a state as the rollout's last one.
    ///
    /// - `positions`: one for each particle, world frame, metres.
    ///
    /// Fails if it cannot be measured from this start.
    pub fn value(&self, positions: &[[f32; 3]]) -> Result<f64, RunError> {
        let start = self.start;
        let value = match self.metric {
            Metric::Coverage => coverage(positions, &start.grid),
            Metric::NormalizedImprovement => coverage(positions, &start.grid)
                .zip(coverage(&start.positions, &start.grid))
                .and_then(|(now, before)| normalized_improvement(now, before)),
            Metric::ParticleDistance => self.distance_m(positions, u32::MAX),
        };
        value.ok_or_else(|| {
            RunError::Failed(format!(
                "the start `{}` cannot be measured: it covers as much as the flat cloth, or its particles are not those of the experts",
                start.name
            ))
        })
    }

    /// Returns how far a state is from the nearest state of an expert after `folds` folds, metres; its loss where no
    /// expert leads.
    pub(super) fn behind(&self, positions: &[[f32; 3]], folds: u32) -> Result<f64, RunError> {
        match self.distance_m(positions, folds) {
            Some(least) => Ok(least),
            None => Ok(self.loss(self.value(positions)?)),
        }
    }

    /// Returns the distance to the nearest state of an expert after `folds` folds, or after all.
    fn distance_m(&self, positions: &[[f32; 3]], folds: u32) -> Option<f64> {
        let distances = self.experts.iter().filter_map(|(_, states)| {
            let state = states.get(folds as usize).or(states.last())?;
            mean_particle_distance_m(positions, state)
        });
        distances.min_by(f64::total_cmp)
    }

    /// Returns what the experts would do in a state as the fold after `folds` folds.
    pub(super) fn expert_grips(&self, positions: &[[f32; 3]], folds: u32) -> Vec<ExpertGrip> {
        let grips = self.experts.iter().filter_map(|(sequence, states)| {
            let fold = sequence.folds.get(folds as usize)?;
            let off_m = mean_particle_distance_m(positions, states.get(folds as usize)?)?;
            Some((off_m, expert::grip_of(fold, self.start, positions)?))
        });
        grips.collect()
    }

    /// Returns whether a state ends a rollout, because its goal is judged after each step and met.
    pub(super) fn is_reached(&self, value: f64) -> bool {
        self.goal
            .is_some_and(|goal| goal.metric.is_judged_each_step() && goal.is_met(value))
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

/// Simulates the experts fold by fold.
fn experts<'a>(job: &Job<'a>) -> Result<Vec<Expert<'a>>, WorldError> {
    let sequences = &job.program.experts;
    let beginnings = sequences.iter().flat_map(|sequence| {
        (1..=sequence.folds.len()).map(|folds| Sequence {
            folds: sequence.folds[..folds].to_vec(),
        })
    });
    let beginnings: Vec<Sequence> = beginnings.collect();
    let simulated = expert::ends(
        Sequences {
            folds: &beginnings,
            manner: job.program.manner,
        },
        job.start,
        job.make_expert_world,
        job.cache,
        job.interrupt,
        &mut |_| {},
    )?;
    let mut ends = simulated.ends.into_iter().map(|end| end.positions);
    let experts = sequences.iter().map(|sequence| {
        let mut states = vec![job.start.positions.clone()];
        states.extend(ends.by_ref().take(sequence.folds.len()));
        (sequence, states)
    });
    Ok(experts.collect())
}
