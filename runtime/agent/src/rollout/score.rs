//! The score of a rollout: its cloth's distance from the expert results, and its coverage.

use super::RunError;
use super::writer::RolloutWriter;
use super::{Event, Job};
use crate::record::ExpertDistance;
use fab_base::npy;
use fab_program::{Goal, Metric};
use fab_world::World;
use fab_world::expert::{self, Sequences};
use fab_world::metrics;
use std::time::Instant;

/// A final state's distances to the expert results.
pub(super) struct Score {
    /// The nearest sequence, from 1.
    pub sequence: usize,
    /// Distance to it, metres.
    pub distance_m: f64,
    /// All of them.
    pub experts: Vec<ExpertDistance>,
    /// How many expert results had to be simulated.
    pub simulated: usize,
    /// Name of the world that simulated them.
    pub world: String,
}

/// Compares the final state with the expert results, and stores those beside it.
///
/// `None` if there is nothing to score, or nothing to score it against. Fails also if it is interrupted.
pub(super) fn score(
    job: &Job<'_>,
    world: &dyn World,
    keeper: &mut RolloutWriter,
    progress: &mut dyn FnMut(Event),
) -> Result<Option<Score>, RunError> {
    let sequences = &job.program.experts;
    let particles = world.particles().filter(|_| !sequences.is_empty());
    let Some(particles) = particles else {
        return Ok(None);
    };
    let begun = Instant::now();
    let total = sequences.len();
    let results = expert::ends(
        Sequences {
            folds: sequences,
            manner: job.program.manner,
        },
        job.start,
        job.make_expert_world,
        job.cache,
        job.interrupt,
        &mut |missing| progress(Event::Experts { missing, total }),
    )?;
    keeper.timer.add("experts", begun.elapsed());
    if let Some(note) = results.not_kept {
        progress(Event::Note { note });
    }
    let mut nearest: Option<(usize, f64)> = None;
    let mut experts = Vec::with_capacity(results.ends.len());
    for end in &results.ends {
        let distance_m = metrics::mean_particle_distance_m(&particles, &end.positions);
        let Some(distance_m) = distance_m else {
            continue;
        };
        let sequence = end.sequence + 1;
        let file = format!("experts/{sequence}.npy");
        experts.push(ExpertDistance {
            sequence,
            file: keeper.folder.keep(&file, &npy::encode(&end.positions))?,
            distance_mm: distance_m * 1000.0,
            folds: sequences[end.sequence].folds.clone(),
        });
        if nearest.is_none_or(|(_, least_m)| distance_m < least_m) {
            nearest = Some((sequence, distance_m));
        }
    }
    Ok(nearest.map(|(sequence, distance_m)| Score {
        sequence,
        distance_m,
        experts,
        simulated: results.simulated,
        world: results.world,
    }))
}

/// Returns whether a final distance reaches the goal; goals judged after each step are already decided.
pub(super) fn meets(goal: Option<&Goal>, distance_m: f64) -> bool {
    goal.is_some_and(|goal| goal.metric == Metric::ParticleDistance && goal.is_met(distance_m))
}
