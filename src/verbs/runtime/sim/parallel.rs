//! Simulates many cloths side by side.

use crate::exit::Failure;
use crate::io::Io;
use clap::Args;
use std::num::NonZero;
use std::thread;

pub use fab_base::parallel::in_parallel;

/// How many cloths are simulated side by side.
#[derive(Args)]
pub struct ThreadArguments {
    /// Cloths simulated side by side; default: one per core.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=super::MAX_THREADS))]
    pub threads: Option<u16>,
}

/// Returns the number of threads asked for, or one per core.
pub fn threads(arguments: &ThreadArguments) -> usize {
    arguments.threads.map_or_else(
        || thread::available_parallelism().map_or(1, NonZero::get),
        usize::from,
    )
}

/// Simulates `count` cloths, with a line of progress; the first failure or an interrupt ends all.
///
/// - `what`: what is done with each, such as `crumpled`.
pub fn each<T: Send>(
    count: usize,
    arguments: &ThreadArguments,
    what: &str,
    io: &Io,
    simulate: impl Fn(usize) -> Result<T, Failure> + Sync,
) -> Result<Vec<T>, Failure> {
    let show = |done: usize| io.progress(&format!("{done} of {count} {what}"));
    show(0);
    let simulate = |index| simulate(index).map(Some);
    let results = in_parallel(count, threads(arguments), simulate, show);
    io.progress("");
    Ok(results?.into_iter().flatten().collect())
}
