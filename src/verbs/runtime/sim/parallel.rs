//! How many threads a verb of the simulator starts.

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
