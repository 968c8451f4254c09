//! The score of a rollout: its cloth's distance from the expert results, and its coverage.

use super::writer::RolloutWriter;
use super::{Event, Job, RunError};
use fab_program::{Goal, Metric};
use fab_world::expert;
use fab_world::expert::{ExpertEnds, Sequences};
use fab_world::metrics;
use fab_world::{World, WorldError};
use std::time::Instant;

/// A final state's distances to the expert results.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Index of the nearest sequence in the program.
    pub sequence: usize,
    /// Distance to it, metres.
    pub distance_m: f64,
    /// All of them: sequence, distance in metres, file in the run folder.
    pub distances: Vec<(usize, f64, String)>,
    /// How many expert results had to be simulated.
    pub simulated: usize,
    /// Name of the world that simulated them.
    pub world: String,
}

/// The result of scoring.
pub(super) enum Scored {
    /// There is nothing to score, or nothing to score it against.
    Absent,
    Interrupted,
    Found(Score),
}

impl Scored {
    pub(super) fn found(&self) -> Option<&Score> {
        match self {
            Scored::Found(score) => Some(score),
            _ => None,
        }
    }
}

/// Compares the final state with the expert results, and stores those beside it.
pub(super) fn score(
    job: &Job<'_>,
    world: &dyn World,
    keeper: &mut RolloutWriter,
    progress: &mut dyn FnMut(Event),
) -> Result<Scored, RunError> {
    let Some(particles) = world
        .particles()
        .filter(|_| !job.program.experts.is_empty())
    else {
        return Ok(Scored::Absent);
    };
    let begun = Instant::now();
    let total = job.program.experts.len();
    let mut announce = |missing: usize| progress(Event::Experts { missing, total });
    let ends = expert::ends(
        Sequences {
            folds: &job.program.experts,
            manner: job.program.manner,
        },
        job.start,
        job.make_expert_world,
        job.cache,
        job.interrupt,
        &mut announce,
    );
    let ExpertEnds {
        ends,
        world: expert_world,
        simulated,
        not_kept,
    } = match ends {
        Ok(ends) => ends,
        Err(WorldError::Interrupted) => return Ok(Scored::Interrupted),
        Err(error) => return Err(error.into()),
    };
    keeper.timer.add("experts", begun.elapsed());
    if let Some(note) = not_kept {
        progress(Event::Note { note });
    }
    let mut distances = Vec::with_capacity(ends.len());
    for end in &ends {
        if let Some(distance_m) = metrics::mean_particle_distance_m(&particles, &end.positions) {
            let file = keeper.keep_expert(end)?;
            distances.push((end.sequence, distance_m, file));
        }
    }
    let nearest = distances.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    Ok(match nearest {
        Some(&(sequence, distance_m, _)) => Scored::Found(Score {
            sequence,
            distance_m,
            distances,
            simulated,
            world: expert_world,
        }),
        None => Scored::Absent,
    })
}

/// Returns whether a final distance reaches the goal; goals judged after each step are already decided.
pub(super) fn meets(goal: Option<&Goal>, distance_m: f64) -> bool {
    goal.is_some_and(|goal| goal.metric == Metric::ParticleDistance && goal.is_met(distance_m))
}
