//! The first questions of a suite's entries, for estimates.

use super::lay_starts::lay_for;
use super::play::{at, place, program_of};
use super::{Bench, BenchError};
use fab_agent::rollout::{FirstQuestion, Job, first_questions};

/// Lays the first start of each entry and renders its stages' first questions, in the order of the entries.
///
/// Fails if a start cannot be laid, or the user interrupts.
pub fn first_questions_of(bench: &Bench<'_>) -> Result<Vec<Vec<FirstQuestion>>, BenchError> {
    let mut all = Vec::with_capacity(bench.entries.len());
    for entry in &bench.entries {
        let place = place(bench, entry, 0);
        let program = program_of(bench, entry, 0)?;
        let task = &bench.tasks[entry.task];
        let values = entry.values(&task.starts[0]);
        // An estimate must not ask anybody to lay a cloth, or connect to anything.
        let make_world = || match &bench.arm {
            Some(arm) => (arm.make_look)(program),
            None => (bench.make_world)(program, &values),
        };
        let start = lay_for(bench, entry, 0);
        let start = start.map_err(|error| at(&place, error))?;
        let job = Job {
            program,
            start: &start,
            subgoals: &entry.subgoals,
            examples: &entry.examples,
            make_policy: entry.make_policy,
            budget: bench.budget,
            recorder: None,
            make_world: &make_world,
            make_expert_world: &make_world,
            cache: bench.cache,
            interrupt: bench.interrupt,
            horizon: bench.suite.horizons.last().copied(),
            early_stop: true,
            operator: None,
            repetition: 0,
            start_number: None,
        };
        all.push(match entry.models {
            Some(models) => {
                first_questions(&job, models).map_err(|error| BenchError::Run { place, error })?
            }
            None => Vec::new(),
        });
    }
    Ok(all)
}
