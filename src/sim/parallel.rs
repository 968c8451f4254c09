//! How many threads a verb of the simulator starts.

use crate::cli::sim::ThreadArguments;
use std::num::NonZero;
use std::thread;

pub use fab_base::parallel::in_parallel;

/// Returns the number of threads asked for, or one per core.
pub fn threads(arguments: &ThreadArguments) -> usize {
    arguments.threads.map_or_else(
        || thread::available_parallelism().map_or(1, NonZero::get),
        usize::from,
    )
}
