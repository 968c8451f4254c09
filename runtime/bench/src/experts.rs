//! The expert end states that a suite's rollouts are compared with.
//!
//! In: the suite's programs and laid starts. Out: ends in the cache before any rollout needs them, and distances to
//! them. For a fold fraction below 1, each fold of the sequence is shortened accordingly.

use super::lay_starts::LaidStarts;
use super::play::{ExpertDistance, Progress, Spent, at, place};
use super::record::Rollout;
use super::{Bench, BenchError, Entry};
use fab_agent::rollout::Job;
use fab_base::parallel::in_parallel;
use fab_program::{Program, Sequence};
use fab_world::expert::{self, MakeWorld, Sequences};
use fab_world::{World, WorldError, metrics};
use std::collections::BTreeSet;

/// Returns a program's sequences for comparison, with each fold ending at a fraction of its length.
fn sequences(program: &Program, fraction: f64) -> Vec<Sequence> {
    let mut sequences = program.experts.clone();
    for sequence in &mut sequences {
        for fold in &mut sequence.folds {
            fold.fraction *= fraction;
        }
    }
    sequences
}

/// Returns the fractions that the suite's metrics need.
fn fractions(bench: &Bench<'_>) -> Vec<f64> {
    let metrics = bench.suite.metrics.iter();
    metrics
        .filter_map(|metric| metric.row().fold_fraction)
        .collect()
}

/// Makes the world in which an entry's rollout of a start takes place.
fn make_world(
    bench: &Bench<'_>,
    entry: &Entry<'_>,
    start: usize,
    program: &Program,
) -> Result<Box<dyn World>, WorldError> {
    let values = entry.values(&bench.tasks[entry.task].starts[start]);
    (bench.make_world)(program, &values)
}

/// Simulates every expert end that is not cached yet; returns whether all are available.
pub(super) fn simulate(
    bench: &Bench<'_>,
    laid: &LaidStarts,
    progress: &Progress<'_>,
    spent: &mut Spent,
) -> Result<bool, BenchError> {
    let mut jobs = Vec::new();
    let mut known = BTreeSet::new();
    for (number, entry) in bench.entries.iter().enumerate() {
        for (start, laid) in laid[number].iter().enumerate() {
            let program = entry.program(&bench.tasks[entry.task].starts[start]);
            let digest = laid.digest();
            let world = make_world(bench, entry, start, program);
            let world = world.map_err(|error| at(&place(bench, entry, start), error))?;
            for sequence in fractions(bench)
                .iter()
                .flat_map(|it| sequences(program, *it))
            {
                let text = serde_json::to_string(&(world.parameters(), &sequence, &digest));
                if known.insert(text.unwrap_or_default()) {
                    jobs.push((number, start, sequence));
                }
            }
        }
    }
    spent.experts = jobs.len();
    if jobs.is_empty() {
        return Ok(true);
    }
    progress("expert ends known", 0, jobs.len());
    let done = in_parallel(
        jobs.len(),
        bench.threads,
        |index| {
            let (number, start, sequence) = &jobs[index];
            let entry = &bench.entries[*number];
            let program = entry.program(&bench.tasks[entry.task].starts[*start]);
            // One sequence per job, so that the job starts no thread of its own.
            let ends = expert::ends(
                Sequences {
                    folds: std::slice::from_ref(sequence),
                    manner: program.manner,
                },
                &laid[*number][*start],
                &|| make_world(bench, entry, *start, program),
                bench.cache,
                bench.interrupt,
                &mut |_| {},
            );
            match ends {
                Ok(ends) => Ok(Some(ends.simulated)),
                Err(WorldError::Interrupted) => Ok(None),
                Err(error) => Err(at(&place(bench, entry, *start), error)),
            }
        },
        |done| progress("expert ends known", done, jobs.len()),
    )?;
    spent.experts_simulated = done.iter().flatten().sum();
    Ok(done.iter().all(Option::is_some))
}

/// A distance between two states, metres.
type Measure = fn(&[[f32; 3]], &[[f32; 3]]) -> Option<f64>;

/// Scores the last state of a rollout, however it ended; the start itself if nothing was executed.
pub(super) fn distances(
    bench: &Bench<'_>,
    job: &Job<'_>,
    rollout: &Rollout,
) -> Result<Vec<ExpertDistance>, WorldError> {
    let last = rollout.last.as_ref().unwrap_or(&job.start.positions);
    let make_world: &MakeWorld<'_> = job.make_expert_world;
    let mut distances = Vec::new();
    for fraction in fractions(bench) {
        let ends = expert::ends(
            Sequences {
                folds: &sequences(job.program, fraction),
                manner: job.program.manner,
            },
            job.start,
            make_world,
            job.cache,
            job.interrupt,
            &mut |_| {},
        )?;
        let nearest = |measure: Measure| {
            let all = { ends.ends.iter() }.filter_map(|end| measure(last, &end.positions));
            all.min_by(f64::total_cmp)
        };
        let mean_m = nearest(metrics::mean_particle_distance_m);
        let shape_m = nearest(metrics::shape_distance_m);
        distances.extend(mean_m.zip(shape_m).map(|(mean_m, shape_m)| ExpertDistance {
            fold_fraction: fraction,
            mean_m,
            shape_m,
        }));
    }
    Ok(distances)
}
