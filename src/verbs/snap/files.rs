//! Examines files in parallel, one thread per core, and adds their snapshots to a plan.

use super::expected::{ExpectedSnapshot, Task};
use super::plan::Plan;
use super::{Declared, SnapArguments};
use crate::exit::Failure;
use crate::io::Io;
use fab_base::parallel::in_parallel;
use std::num::NonZero;
use std::path::Path;
use std::thread;

/// Adds all snapshots of some files; stops at the first file, in their order, that fails.
pub fn add_expected(
    declared: &[Declared],
    arguments: &SnapArguments,
    plan: &mut Plan,
    io: &Io,
) -> Result<(), Failure> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let known: &Plan = plan;
    // A failure is a result here, since another file's may come first in their order.
    let look = |index: usize| Ok(Some(of_file(&declared[index], arguments, known, io)));
    let found = in_parallel(declared.len(), threads, look, |_| {});
    let found = found.map_err(|error: std::io::Error| Failure::environment(error))?;
    for (one, found) in declared.iter().zip(found.into_iter().flatten()) {
        plan.looked_at(&source_of(&one.file));
        for (name, intended) in found? {
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
