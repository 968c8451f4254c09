//! Lays the starts of a suite before its rollouts.
//!
//! In: a bench. Out: for each entry a start for each of its task's points, as positions; only in words if a person lays
//! the cloths. A varied start is laid in the task's own world, with a cloth of the drawn size, and then moved: how it
//! lies does not depend on other axes, so that figures at equal starts can be compared.

use super::on_arm::{self, Cloths};
use super::play::{Progress, at, place};
use super::{Bench, BenchError, Entry};
use fab_base::parallel::in_parallel;
use fab_world::WorldError;
use fab_world::start::Start;
use fab_world::vary::{AxisValues, Placement};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The laid starts of every entry.
pub(super) type LaidStarts = Vec<Vec<Arc<Start>>>;

/// Lays every start; `None` if the user interrupts.
pub(super) fn lay(
    bench: &Bench<'_>,
    progress: &Progress<'_>,
) -> Result<Option<LaidStarts>, BenchError> {
    // Most entries share their starts. A size is told apart by its bits.
    let mut jobs = BTreeMap::new();
    for entry in &bench.entries {
        for start in 0..bench.tasks[entry.task].starts.len() {
            let size = placement(bench, entry, start).size;
            jobs.entry((entry.task, start, size.to_bits()))
                .or_insert((entry, start));
        }
    }
    let todo: Vec<_> = jobs.values().copied().collect();
    progress("starts laid", 0, todo.len());
    let laid = in_parallel(
        todo.len(),
        bench.threads,
        |index| {
            let (entry, start) = todo[index];
            match lay_unmoved(bench, entry, start) {
                Ok(start) => Ok(Some(Arc::new(start))),
                Err(WorldError::Interrupted) => Ok(None),
                Err(error) => Err(at(&place(bench, entry, start), error)),
            }
        },
        |done| progress("starts laid", done, todo.len()),
    )?;
    let Some(laid) = laid.into_iter().collect::<Option<Vec<_>>>() else {
        return Ok(None);
    };
    let unmoved: BTreeMap<_, _> = jobs.into_keys().zip(laid).collect();
    let starts_of = |entry: &Entry<'_>| {
        let starts = (0..bench.tasks[entry.task].starts.len()).map(|start| {
            let placement = placement(bench, entry, start);
            let laid = &unmoved[&(entry.task, start, placement.size.to_bits())];
            match moved(Start::clone(laid), placement) {
                // The same positions need not be kept for each entry.
                start if start == **laid => Arc::clone(laid),
                start => Arc::new(start),
            }
        });
        starts.collect()
    };
    Ok(Some(bench.entries.iter().map(starts_of).collect()))
}

/// Lays one start of an entry; if a person does that, the start only says how in words.
pub(super) fn lay_for(
    bench: &Bench<'_>,
    entry: &Entry<'_>,
    start: usize,
) -> Result<Start, WorldError> {
    let laid = lay_unmoved(bench, entry, start)?;
    Ok(moved(laid, placement(bench, entry, start)))
}

fn lay_unmoved(bench: &Bench<'_>, entry: &Entry<'_>, start: usize) -> Result<Start, WorldError> {
    let task = &bench.tasks[entry.task];
    let point = task.starts[start].scaled(placement(bench, entry, start).size);
    if is_by_hand(bench) {
        return Ok(on_arm::by_hand(&point));
    }
    let world = (bench.make_world)(&task.program, &AxisValues::default())?;
    point.lay(world.as_ref(), bench.cache, bench.interrupt)
}

fn moved(start: Start, placement: Placement) -> Start {
    start.moved(placement.turn_rad, placement.shift_m)
}

fn placement(bench: &Bench<'_>, entry: &Entry<'_>, start: usize) -> Placement {
    let point = &bench.tasks[entry.task].starts[start];
    entry.values(point).placement()
}

/// Fails if a start of the suite is also an example shown to a model.
pub(super) fn refuse_examples(bench: &Bench<'_>, laid: &LaidStarts) -> Result<(), BenchError> {
    if is_by_hand(bench) {
        return Ok(());
    }
    for (entry, starts) in bench.entries.iter().zip(laid) {
        for start in starts {
            let shown = entry.examples.demonstrations.as_ref();
            if let Some(demonstration) = shown.and_then(|it| it.demonstrates(start)) {
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
