//! The first questions of a suite's entries, for estimates.

use super::lay_starts::lay_for;
use super::play::{at, job, place};
use super::{Bench, BenchError};
use fab_agent::rollout::{FirstQuestion, RunError, first_questions};

/// Lays the first start of each entry and renders its stages' first questions, in the order of the entries.
///
/// A varied world may show nothing to ask about, which is for its rollouts to report. It is then taken to ask what its
/// method asks in the task's own world.
///
/// Fails if a start cannot be laid, or the user interrupts.
pub fn first_questions_of(bench: &Bench<'_>) -> Result<Vec<Vec<FirstQuestion>>, BenchError> {
    let mut all: Vec<Vec<FirstQuestion>> = Vec::with_capacity(bench.entries.len());
    for (number, entry) in bench.entries.iter().enumerate() {
        let place = place(bench, entry, 0);
        let point = &bench.tasks[entry.task].starts[0];
        let (program, values) = (entry.program(point), entry.values(point));
        // An estimate must not ask anybody to lay a cloth, or connect to anything.
        let make_world = || match &bench.arm {
            Some(arm) => (arm.make_look)(program),
            None => (bench.make_world)(program, &values),
        };
        let start = lay_for(bench, entry, 0);
        let start = start.map_err(|error| at(&place, error))?;
        let job = job(bench, entry, program, &start, &make_world);
        let questions = match entry.models {
            Some(models) => first_questions(&job, models),
            None => Ok(Vec::new()),
        };
        let own = bench.entries[..number].iter().rposition(|own| {
            (own.task, &own.method.name, own.variation.name())
                == (entry.task, &entry.method.name, None)
        });
        all.push(match (questions, own) {
            (Err(RunError::Scene(_)), Some(own)) => all[own].clone(),
            (questions, _) => questions.map_err(|error| BenchError::Run { place, error })?,
        });
    }
    Ok(all)
}
