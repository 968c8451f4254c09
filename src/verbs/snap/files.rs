//! Examines files in parallel, one thread per core, and adds their snapshots to a plan.

use super::expected::{ExpectedSnapshot, Task};
use super::plan::Plan;
use super::{Declared, SnapArguments};
use crate::exit::Failure;
use crate::io::Io;
use std::collections::BTreeMap;
use std::num::NonZero;
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Adds all snapshots of some files; stops at the first file, in their order, that fails.
pub fn add_expected(
    declared: &[Declared],
    arguments: &SnapArguments,
    plan: &mut Plan,
    io: &Io,
) -> Result<(), Failure> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let next = AtomicUsize::new(0);
    let known: &Plan = plan;
    let look = || {
        let mut found = Vec::new();
        while let Some(one) = declared.get(next.fetch_add(1, Ordering::Relaxed)) {
            found.push((&one.file, of_file(one, arguments, known, io)));
        }
        found
    };
    let mut found: BTreeMap<&String, Result<Vec<ExpectedSnapshot>, Failure>> =
        thread::scope(|scope| {
            let workers: Vec<_> = (0..threads.min(declared.len()))
                .map(|_| scope.spawn(look))
                .collect();
            let joined = workers.into_iter().map(|worker| worker.join());
            let joined = joined.map(|found| found.unwrap_or_else(|panic| resume_unwind(panic)));
            joined.flatten().collect()
        });
    for Declared { file, .. } in declared {
        plan.looked_at(&source_of(file));
        for (name, intended) in found.remove(file).transpose()?.unwrap_or_default() {
            plan.add_expected(name, intended)?;
        }
    }
    Ok(())
}

/// Returns the name of a file as its snapshots record it.
fn source_of(file: &str) -> String {
    let name = Path::new(file).file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

fn of_file(
    declared: &Declared,
    arguments: &SnapArguments,
    plan: &Plan,
    io: &Io,
) -> Result<Vec<ExpectedSnapshot>, Failure> {
    let Declared { file, programs } = declared;
    let mut snapshots = Vec::new();
    // A task and its variants follow each other.
    for programs in programs.chunk_by(|one, other| one.task == other.task) {
        let mut task = Task::of(programs, &source_of(file), arguments, plan, io)?;
        for program in programs {
            task.add_expected(program, file, plan, io)?;
        }
        snapshots.append(&mut task.snapshots);
    }
    Ok(snapshots)
}
