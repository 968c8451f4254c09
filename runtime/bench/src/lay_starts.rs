//! Lays the starts of a suite before its rollouts.
//!
//! In: a bench. Out: a start for each of its points, as positions; only in words if a person lays the cloths.

use super::on_arm::{self, Cloths};
use super::play::{Phase, at};
use super::starts::StartPoint;
use super::{Bench, BenchError, Task};
use fab_base::parallel::in_parallel;
use fab_world::WorldError;
use fab_world::start::Start;

/// The laid starts of every task.
pub(super) type LaidStarts = Vec<Vec<Start>>;

/// Lays every start; `None` if the user interrupts.
pub(super) fn lay(
    bench: &Bench<'_>,
    progress: &(dyn Fn(Phase, usize, usize) + Sync),
) -> Result<Option<LaidStarts>, BenchError> {
    let tasks = bench.tasks.iter().enumerate();
    let jobs: Vec<(usize, usize)> = tasks
        .flat_map(|(task, it)| (0..it.starts.len()).map(move |start| (task, start)))
        .collect();
    progress(Phase::Starts, 0, jobs.len());
    let laid = in_parallel(
        jobs.len(),
        bench.threads,
        |index| {
            let (task, start) = jobs[index];
            let task = &bench.tasks[task];
            let point = &task.starts[start];
            match lay_one(bench, task, point) {
                Ok(start) => Ok(Some(start)),
                Err(WorldError::Interrupted) => Ok(None),
                Err(error) => {
                    let place = format!("{}, start {}", task.name, point.number);
                    Err(at(&place, error))
                }
            }
        },
        |done| progress(Phase::Starts, done, jobs.len()),
    )?;
    let mut starts: LaidStarts = bench.tasks.iter().map(|_| Vec::new()).collect();
    for ((task, _), start) in jobs.iter().zip(laid) {
        let Some(start) = start else {
            return Ok(None);
        };
        starts[*task].push(start);
    }
    Ok(Some(starts))
}

/// Lays one start; if a person does that, the start only says how in words.
pub(super) fn lay_one(
    bench: &Bench<'_>,
    task: &Task,
    point: &StartPoint,
) -> Result<Start, WorldError> {
    if is_by_hand(bench) {
        return Ok(on_arm::by_hand(point));
    }
    let world = (bench.make_world)(&task.program)?;
    point.lay(world.as_ref(), bench.cache, bench.interrupt)
}

/// Fails if a start of the suite is also an example shown to a model.
pub(super) fn refuse_examples(bench: &Bench<'_>, laid: &LaidStarts) -> Result<(), BenchError> {
    if is_by_hand(bench) {
        return Ok(());
    }
    for entry in &bench.entries {
        for start in &laid[entry.task] {
            if let Some(demonstration) = entry.examples.demonstrates(start) {
                return Err(BenchError::Demonstrated {
                    task: bench.tasks[entry.task].name.clone(),
                    method: entry.method.name.clone(),
                    start: start.name.clone(),
                    demonstration,
                });
            }
        }
    }
    Ok(())
}

fn is_by_hand(bench: &Bench<'_>) -> bool {
    let arm = bench.arm.as_ref();
    arm.is_some_and(|arm| arm.cloths == Cloths::ByHand)
}
