//! The score of a rollout: its cloth's distance from the expert results, and its coverage.

use super::RunError;
use super::writer::RolloutWriter;
use super::{Event, Job};
use crate::record::{ExpertDistance, JudgedBy};
use fab_base::npy;
use fab_program::{Goal, Metric};
use fab_world::World;
use fab_world::expert::{self, Sequences};
use fab_world::metrics;
use std::time::Instant;

/// Compares the final state with the expert results, stores those beside it, and returns its distance from the nearest,
/// metres.
///
/// `None` if there is nothing to score, or nothing to score it against. Fails also if it is interrupted.
pub(super) fn score(
    job: &Job<'_>,
    world: &dyn World,
    keeper: &mut RolloutWriter,
    progress: &mut dyn FnMut(Event),
) -> Result<Option<f64>, RunError> {
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
    let Some((sequence, distance_m)) = nearest else {
        return Ok(None);
    };
    keeper.experts_simulated = results.simulated;
    let end = &mut keeper.end;
    end.nearest_expert = Some(sequence);
    end.experts = Some(experts);
    end.report.mean_particle_distance_mm = Some(distance_m * 1000.0);
    end.report.judged_by = Some(JudgedBy {
        world: results.world,
        grid: [job.start.grid.dimx, job.start.grid.dimy],
    });
    Ok(Some(distance_m))
}

/// Returns whether a final distance reaches the goal; goals judged after each step are already decided.
pub(super) fn meets(goal: Option<&Goal>, distance_m: f64) -> bool {
    goal.is_some_and(|goal| goal.metric == Metric::ParticleDistance && goal.is_met(distance_m))
}
