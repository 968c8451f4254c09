//! Carries out a suite: lays starts, simulates expert ends, runs rollouts, reads what came of them.
//!
//! In: a [`Bench`]. Out: [`Played`] rollouts in a fixed order, and what the parts of the work took. Each part goes
//! over its jobs with as many threads as asked for, and a job starts none of its own: expert ends are there
//! before the first rollout asks for them.

use super::record::{self, Found, Identity, Record};
use super::{Bench, BenchError, Entry, experts};
use crate::calls::{Fault, ledger};
use crate::journal::{JOURNAL_FILE, RunFolder};
use crate::model::described;
use crate::outcome::Outcome;
use crate::parallel::in_parallel;
use crate::rollout::{self, Job, RunError};
use crate::start::Start;
use crate::world::{World, WorldError};
use compiler::program::Program;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// One rollout of a suite.
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// Index of the entry.
    pub entry: usize,
    /// Index of the start among those of the task.
    pub start: usize,
    /// What its folder says.
    pub record: Record,
    /// Distance of its last state to the nearest expert end, metres, by the fraction of the way that each of the
    /// experts' folds goes.
    pub distances_m: Vec<(f64, f64)>,
}

/// What came of a suite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Results {
    /// Finished rollouts, by entry, start and repetition.
    pub rollouts: Vec<Played>,
    /// How many there were to be.
    pub planned: usize,
    /// How many were found finished.
    pub found: usize,
    /// Why rollouts are missing, where some are.
    pub stopped: Option<Stop>,
    /// Name of the world.
    pub world: String,
    /// Hash of the world's parameters.
    pub params: String,
    /// What the work took.
    pub spent: Spent,
}

/// Why a suite was not carried out to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The user stopped it.
    Interrupted,
    /// A cap on calls or cost was reached.
    Capped,
}

/// Wall times, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Spent {
    /// Laying and crumpling starts.
    pub starts_s: f64,
    /// Simulating expert ends that were not kept yet, or finding that all are.
    pub experts_s: f64,
    /// How many were simulated.
    pub experts_simulated: usize,
    /// Of how many.
    pub experts: usize,
    /// Rollouts and their scores.
    pub rollouts_s: f64,
}

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Starts are laid.
    Starts,
    /// Expert ends are simulated.
    Experts,
    /// Rollouts are run.
    Rollouts,
}

/// Carries out a suite.
///
/// `progress` is told how many jobs of a phase are done, and how many there are.
pub fn play(
    bench: &Bench<'_>,
    progress: &(dyn Fn(Phase, usize, usize) + Sync),
) -> Result<Results, BenchError> {
    let mut results = Results::default();
    let begun = Instant::now();
    let Some(laid) = lay(bench, progress)? else {
        return Ok(interrupted(results));
    };
    results.spent.starts_s = begun.elapsed().as_secs_f64();
    refuse_examples(bench, &laid)?;
    (results.world, results.params) = world(bench)?;
    let begun = Instant::now();
    let is_whole = experts::simulate(bench, &laid, progress, &mut results.spent)?;
    results.spent.experts_s = begun.elapsed().as_secs_f64();
    if !is_whole {
        return Ok(interrupted(results));
    }
    let begun = Instant::now();
    let jobs = rollouts(bench);
    results.planned = jobs.len();
    // What earlier calls of this suite did counts towards its caps.
    for which in &jobs {
        bench
            .budget
            .restore(&ledger::read(&folder_of(bench, *which))?.spent);
    }
    progress(Phase::Rollouts, 0, jobs.len());
    // One person sees one rollout at a time.
    let side_by_side = bench.operator.map_or(bench.threads, |_| 1);
    let done = in_parallel(
        jobs.len(),
        side_by_side,
        |index| one(bench, &laid, jobs[index]),
        |done| progress(Phase::Rollouts, done, jobs.len()),
    )?;
    for (played, was_found) in done.into_iter().flatten() {
        results.found += usize::from(was_found);
        results.rollouts.push(played);
    }
    results.spent.rollouts_s = begun.elapsed().as_secs_f64();
    if results.rollouts.len() < results.planned {
        results.stopped = Some(match bench.interrupt.is_raised() {
            true => Stop::Interrupted,
            false => Stop::Capped,
        });
    }
    Ok(results)
}

/// Fails where a start of the suite is one that a model is told as an example.
fn refuse_examples(bench: &Bench<'_>, laid: &Laid) -> Result<(), BenchError> {
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

fn interrupted(results: Results) -> Results {
    Results {
        stopped: Some(Stop::Interrupted),
        ..results
    }
}

/// Returns the name and the parameters of the world.
fn world(bench: &Bench<'_>) -> Result<(String, String), BenchError> {
    let Some(task) = bench.tasks.first() else {
        return Ok(<_>::default());
    };
    let world = (bench.make_world)(&task.program).map_err(|error| at(&task.name, error))?;
    Ok((world.name().to_owned(), world.parameters()))
}

pub(super) fn at(place: &str, error: WorldError) -> BenchError {
    BenchError::World {
        place: place.to_owned(),
        error,
    }
}

/// The starts of every task, laid.
pub(super) type Laid = Vec<Vec<Start>>;

/// Lays every start; None where the user stopped it.
fn lay(
    bench: &Bench<'_>,
    progress: &(dyn Fn(Phase, usize, usize) + Sync),
) -> Result<Option<Laid>, BenchError> {
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
            let place = format!("{}, start {}", task.name, point.number);
            let world = (bench.make_world)(&task.program).map_err(|error| at(&place, error))?;
            match point.lay(world.as_ref(), bench.cache, bench.interrupt) {
                Ok(start) => Ok(Some(start)),
                Err(WorldError::Interrupted) => Ok(None),
                Err(error) => Err(at(&place, error)),
            }
        },
        |done| progress(Phase::Starts, done, jobs.len()),
    )?;
    let mut starts: Laid = bench.tasks.iter().map(|_| Vec::new()).collect();
    for ((task, _), start) in jobs.iter().zip(laid) {
        let Some(start) = start else {
            return Ok(None);
        };
        starts[*task].push(start);
    }
    Ok(Some(starts))
}

pub(super) fn place(bench: &Bench<'_>, entry: &Entry<'_>, start: usize) -> String {
    let task = &bench.tasks[entry.task];
    format!("{}, start {}", task.name, task.starts[start].number)
}

pub(super) fn program_of<'b>(
    bench: &Bench<'_>,
    entry: &'b Entry<'_>,
    start: usize,
) -> Result<&'b Program, BenchError> {
    let grid = bench.tasks[entry.task].starts[start].grid();
    entry
        .programs
        .get(&grid)
        .ok_or_else(|| BenchError::NoProgram {
            place: place(bench, entry, start),
            grid,
        })
}

/// Entry, start and repetition of a rollout.
type Which = (usize, usize, u32);

/// Lists the rollouts in the order of tables.
fn rollouts(bench: &Bench<'_>) -> Vec<Which> {
    let entries = bench.entries.iter().enumerate();
    let all = entries.flat_map(|(number, entry)| {
        let starts = 0..bench.tasks[entry.task].starts.len();
        starts.flat_map(move |start| (0..entry.repeats).map(move |repeat| (number, start, repeat)))
    });
    all.collect()
}

/// Returns the folder of a rollout, below the suite's.
fn folder_of(bench: &Bench<'_>, (entry, start, repetition): Which) -> PathBuf {
    let entry = &bench.entries[entry];
    let task = &bench.tasks[entry.task];
    let name = format!("start-{:03}-{}", task.starts[start].number, repetition + 1);
    bench
        .out
        .join(&task.name)
        .join(&entry.method.name)
        .join(name)
}

/// Finds or runs a rollout, and scores its last state; None where it was stopped.
fn one(bench: &Bench<'_>, laid: &Laid, which: Which) -> Result<Option<(Played, bool)>, BenchError> {
    let (number, start, repetition) = which;
    let entry = &bench.entries[number];
    let program = program_of(bench, entry, start)?;
    let start_at = &laid[entry.task][start];
    let folder = folder_of(bench, which);
    let make_world = || (bench.make_world)(program);
    let job = Job {
        program,
        start: start_at,
        subgoals: &entry.subgoals,
        examples: &entry.examples,
        models: entry.models,
        budget: bench.budget,
        recorder: bench.recorder,
        make_world: &make_world,
        make_expert_world: &make_world,
        cache: bench.cache,
        interrupt: bench.interrupt,
        horizon: bench.suite.horizons.last().copied(),
        early_stop: entry.stops_early(&bench.suite.metrics),
        operator: bench.operator,
        repetition,
    };
    let world = make_world().map_err(|error| at(&place(bench, entry, start), error))?;
    let identity = identity(&job, world.as_ref());
    let (record, was_found) = match record::find(&folder, &identity) {
        // What a model could not be had for is tried again.
        Found::Finished(record) if record.outcome != Outcome::ModelFailed => (record, true),
        Found::Other(why) => return Err(BenchError::Other { folder, why }),
        Found::Finished(_) | Found::Unfinished => match run(&job, &folder, &identity)? {
            Some(record) => (record, false),
            None => return Ok(None),
        },
    };
    let distances_m = match experts::distances_m(bench, &job, &record) {
        Ok(distances_m) => distances_m,
        Err(WorldError::Interrupted) => return Ok(None),
        Err(error) => return Err(at(&place(bench, entry, start), error)),
    };
    let played = Played {
        entry: number,
        start,
        record,
        distances_m,
    };
    Ok(Some((played, was_found)))
}

fn identity(job: &Job<'_>, world: &dyn World) -> Identity {
    Identity {
        program: job.program.hash(),
        params: world.parameters(),
        code: world.code(),
        start: job.start.digest(),
        models: [job.models.vision, job.models.text].map(described),
        horizon: job.horizon(),
        early_stop: job.early_stop,
        repetition: job.repetition,
    }
}

/// Runs a rollout into its folder, or goes on with one that was cut off; None where it is stopped.
fn run(job: &Job<'_>, folder: &Path, identity: &Identity) -> Result<Option<Record>, BenchError> {
    if job.interrupt.is_raised() {
        return Ok(None);
    }
    let failed = |error: RunError| BenchError::Run {
        place: folder.display().to_string(),
        error,
    };
    let open = match folder.join(JOURNAL_FILE).is_file() {
        true => RunFolder::reopen(folder),
        false => RunFolder::create(folder),
    };
    let open = open.map_err(|error| failed(error.into()))?;
    let report = rollout::run(job, open, &mut |_| {}).map_err(failed)?;
    if let Outcome::Interrupted | Outcome::BudgetExhausted = report.outcome {
        return Ok(None);
    }
    let hopeless = [Fault::NotAuthorised, Fault::QuotaExhausted].map(Fault::name);
    let named = hopeless
        .into_iter()
        .find(|fault| report.faults.contains_key(*fault));
    if let (Outcome::ModelFailed, Some(fault)) = (report.outcome, named) {
        return Err(BenchError::Refused {
            folder: folder.to_owned(),
            fault,
        });
    }
    match record::find(folder, identity) {
        Found::Finished(record) => Ok(Some(record)),
        Found::Other(why) => Err(BenchError::Other {
            folder: folder.to_owned(),
            why,
        }),
        Found::Unfinished => Ok(None),
    }
}
