//! Runs a suite: lays starts, simulates expert ends, runs rollouts, reads the results.
//!
//! In: a [`Bench`]. Out: [`Played`] rollouts in a fixed order, and the time spent on each phase. Each phase runs its
//! jobs on the requested number of threads, and a job starts no threads of its own: expert ends are available before
//! the first rollout needs them.

use super::lay_starts::{self, LaidStarts};
use super::on_arm::{self, ArmStop, Cloths};
use super::record::{self, FolderContents, Identity, Rollout};
use super::{Answers, Bench, BenchError, Entry, experts};
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::record::RECORD_FILE;
use fab_agent::rollout::{self, Event, Job, RunError};
use fab_base::parallel::in_parallel;
use fab_model::calls::{Fault, ledger};
use fab_program::Program;
use fab_world::expert::MakeWorld;
use fab_world::start::Start;
use fab_world::vary::AxisValues;
use fab_world::{About, WorldError};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// One rollout of a suite.
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// Index of the entry.
    pub entry: usize,
    /// Index of the start among those of the task.
    pub start: usize,
    /// The contents of its folder.
    pub rollout: Rollout,
    /// Distances of its last state to the nearest expert end, for each fraction of the experts' folds.
    pub distances: Vec<ExpertDistance>,
}

/// How far a rollout's last state is from the nearest expert results.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpertDistance {
    /// The fraction of its length at which each expert fold ends.
    pub fold_fraction: f64,
    /// Mean distance of particles, metres.
    pub mean_m: f64,
    /// The same after the best shift and turn, metres.
    pub shape_m: f64,
}

/// The results of a suite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Results {
    /// Finished rollouts, by entry, start and repetition.
    pub rollouts: Vec<Played>,
    /// How many rollouts were planned.
    pub planned: usize,
    /// How many were already finished.
    pub found: usize,
    /// The folders of interrupted rollouts on an arm, which are not resumed.
    pub cut_off: Vec<PathBuf>,
    /// The rollout that failed because of the arm, or did not leave it at rest with an empty hand, if any.
    pub arm_stop: Option<ArmStop>,
    /// Why rollouts are missing, if any are.
    pub stopped: Option<StopReason>,
    /// Name of the world.
    pub world: String,
    /// Hash of the world's parameters.
    pub params: String,
    /// The time spent.
    pub spent: Spent,
}

/// Why a suite stopped early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// The user stopped it.
    Interrupted,
    /// A cap on calls or cost was reached.
    Capped,
    /// A rollout failed because of the arm, or did not leave it at rest with an empty hand.
    Arm,
}

/// Wall times, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Spent {
    /// Laying and crumpling starts.
    pub starts_s: f64,
    /// Simulating missing expert ends, or finding that none are missing.
    pub experts_s: f64,
    /// How many were simulated.
    pub experts_simulated: usize,
    /// Out of this total.
    pub experts: usize,
    /// Rollouts and their scores.
    pub rollouts_s: f64,
}

/// Is told what is done in a phase, the number of finished jobs, and that of all.
pub type Progress<'p> = dyn Fn(&str, usize, usize) + Sync + 'p;

/// Runs a suite.
pub fn play(bench: &Bench<'_>, progress: &Progress<'_>) -> Result<Results, BenchError> {
    let mut results = Results::default();
    let begun = Instant::now();
    // Replaced unless the user stops it before the rollouts.
    results.stopped = Some(StopReason::Interrupted);
    let Some(laid) = lay_starts::lay(bench, progress)? else {
        return Ok(results);
    };
    results.spent.starts_s = begun.elapsed().as_secs_f64();
    lay_starts::refuse_examples(bench, &laid)?;
    if let Some(task) = bench.tasks.first() {
        let about = about(bench, &task.program, &AxisValues::default())
            .map_err(|error| at(&task.name, error))?;
        (results.world, results.params) = (about.name, about.parameters);
    }
    let begun = Instant::now();
    let is_whole = experts::simulate(bench, &laid, progress, &mut results.spent)?;
    results.spent.experts_s = begun.elapsed().as_secs_f64();
    if !is_whole {
        return Ok(results);
    }
    let begun = Instant::now();
    let jobs = rollouts(bench);
    results.planned = jobs.len();
    // Earlier calls of this suite count towards its caps.
    for which in &jobs {
        let noted = ledger::read(&folder_of(bench, *which))?;
        bench.budget.restore(&noted.spent);
    }
    progress("rollouts finished", 0, jobs.len());
    let done = match &bench.arm {
        Some(_) => on_arm::play(bench, &laid, &jobs, progress)?,
        None => side_by_side(bench, &laid, &jobs, progress)?,
    };
    for (played, was_found) in done.played {
        results.found += usize::from(was_found);
        results.rollouts.push(played);
    }
    results.spent.rollouts_s = begun.elapsed().as_secs_f64();
    let missing = jobs.len() - results.rollouts.len() - done.cut_off.len();
    results.stopped = match (done.stop, bench.interrupt.is_raised()) {
        (Some(stop), _) => Some(stop),
        (None, _) if missing == 0 => None,
        (None, true) => Some(StopReason::Interrupted),
        (None, false) => Some(StopReason::Capped),
    };
    (results.cut_off, results.arm_stop) = (done.cut_off, done.arm_stop);
    Ok(results)
}

/// Runs rollouts in the simulator.
fn side_by_side(
    bench: &Bench<'_>,
    laid: &LaidStarts,
    jobs: &[Which],
    progress: &Progress<'_>,
) -> Result<on_arm::Done, BenchError> {
    let ended: Result<_, BenchError> = in_parallel(
        jobs.len(),
        bench.side_by_side(),
        |index| match one(bench, laid, jobs[index])? {
            JobEnd::Played(played, was_found) => Ok(Some((*played, was_found))),
            JobEnd::CutOff | JobEnd::Stopped(_) => Ok(None),
        },
        |done| progress("rollouts finished", done, jobs.len()),
    );
    Ok(on_arm::Done {
        played: ended?.into_iter().flatten().collect(),
        ..on_arm::Done::default()
    })
}

/// Describes a program's world, with some values of its own.
fn about(bench: &Bench<'_>, program: &Program, values: &AxisValues) -> Result<About, WorldError> {
    let material = program.cloth.material.as_ref();
    if let Some(arm) = &bench.arm {
        // A real cloth is what it is.
        let material = material.filter(|_| arm.cloths == Cloths::Simulated);
        return Ok(arm.about.with_material(material));
    }
    if let Some(elsewhere) = &bench.elsewhere {
        return Ok(elsewhere.about.with_material(material));
    }
    Ok(About::of((bench.make_world)(program, values)?.as_ref()))
}

pub(super) fn at(place: &str, error: WorldError) -> BenchError {
    let place = place.to_owned();
    BenchError::World { place, error }
}

pub(super) fn place(bench: &Bench<'_>, entry: &Entry<'_>, start: usize) -> String {
    let task = &bench.tasks[entry.task];
    let varied = entry.variation.name().map(|it| format!(", varied: {it}"));
    let (name, number) = (&task.name, task.starts[start].number);
    format!("{name}, start {number}{}", varied.unwrap_or_default())
}

/// Entry, start and repetition of a rollout.
pub(super) type Which = (usize, usize, u32);

/// Lists the rollouts in the order of tables.
fn rollouts(bench: &Bench<'_>) -> Vec<Which> {
    let mut all = Vec::new();
    for (number, entry) in bench.entries.iter().enumerate() {
        for start in 0..bench.tasks[entry.task].starts.len() {
            all.extend((0..entry.repeats).map(|repeat| (number, start, repeat)));
        }
    }
    all
}

/// Returns the folder of a rollout, below the suite's folder.
pub(super) fn folder_of(bench: &Bench<'_>, (entry, start, repetition): Which) -> PathBuf {
    let entry = &bench.entries[entry];
    let task = &bench.tasks[entry.task];
    let name = format!("start-{:03}-{}", task.starts[start].number, repetition + 1);
    let mut folder = bench.out.join(&task.name).join(&entry.method.name);
    folder.extend(entry.variation.name());
    folder.join(name)
}

/// The result of one rollout.
pub(super) enum JobEnd {
    /// It has ended; the flag says whether it was already finished before.
    Played(Box<Played>, bool),
    /// It was interrupted on an arm, and is not resumed.
    CutOff,
    /// It was stopped, or not started.
    Stopped(StopReason),
}

/// Finds or runs a rollout, and scores its last state.
pub(super) fn one(
    bench: &Bench<'_>,
    laid: &LaidStarts,
    which: Which,
) -> Result<JobEnd, BenchError> {
    let (number, start, repetition) = which;
    let entry = &bench.entries[number];
    let point = &bench.tasks[entry.task].starts[start];
    let (program, values) = (entry.program(point), entry.values(point));
    let folder = folder_of(bench, which);
    let make_simulated = || (bench.make_world)(program, &values);
    let make_world = || match (&bench.arm, &bench.elsewhere) {
        (Some(arm), _) => (arm.make_world)(program, &folder),
        (None, Some(elsewhere)) => (elsewhere.make_world)(program, &folder),
        (None, None) => make_simulated(),
    };
    let job = Job {
        make_world: &make_world,
        make_expert_world: &make_simulated,
        early_stop: entry.stops_early(&bench.suite.metrics),
        operator: bench.operator,
        repetition,
        start_number: match bench.answers {
            Answers::PerStart => Some(point.number),
            Answers::Shared => None,
        },
        ..job(bench, entry, program, &laid[number][start], &make_simulated)
    };
    let about =
        about(bench, program, &values).map_err(|error| at(&place(bench, entry, start), error))?;
    let identity = identity(&job, entry, about, values.clone());
    // An interrupted rollout cannot be repeated from its start there.
    let is_once = bench.arm.is_some() || bench.elsewhere.as_ref().is_some_and(|it| !it.repeats);
    let (rollout, was_found) = match record::find(&folder, &identity) {
        // Failures of a model or a program are retried, unless an arm has moved the cloth since.
        FolderContents::Finished(rollout) if is_once || !is_retried(rollout.report.outcome) => {
            (*rollout, true)
        }
        FolderContents::Other(why) => return Err(BenchError::Other(folder, why)),
        FolderContents::Unfinished if is_once && on_arm::has_begun(&folder) => {
            return Ok(JobEnd::CutOff);
        }
        FolderContents::Finished(_) | FolderContents::Unfinished => {
            let listen = &mut |event| (bench.listen)(&folder, event);
            match run(&job, &folder, &identity, listen)? {
                Ok(rollout) => (rollout, false),
                Err(stop) => return Ok(JobEnd::Stopped(stop)),
            }
        }
    };
    let distances = match experts::distances(bench, &job, &rollout) {
        Ok(distances) => distances,
        Err(WorldError::Interrupted) => return Ok(JobEnd::Stopped(StopReason::Interrupted)),
        Err(error) => return Err(at(&place(bench, entry, start), error)),
    };
    let played = Played {
        entry: number,
        start,
        rollout,
        distances,
    };
    Ok(JobEnd::Played(Box::new(played), was_found))
}

fn is_retried(outcome: Outcome) -> bool {
    matches!(outcome, Outcome::ModelFailed | Outcome::PolicyFailed)
}

/// Returns what all rollouts of an entry from a start have in common.
pub(super) fn job<'j>(
    bench: &'j Bench<'_>,
    entry: &'j Entry<'_>,
    program: &'j Program,
    start: &'j Start,
    make_world: &'j MakeWorld<'j>,
) -> Job<'j> {
    Job {
        program,
        start,
        subgoals: &entry.subgoals,
        examples: &entry.examples,
        make_policy: entry.make_policy,
        budget: bench.budget,
        make_world,
        make_expert_world: make_world,
        cache: bench.cache,
        interrupt: bench.interrupt,
        horizon: bench.suite.horizons.last().copied(),
        early_stop: true,
        operator: None,
        repetition: 0,
        start_number: None,
    }
}

fn identity(job: &Job<'_>, entry: &Entry<'_>, about: About, vary: AxisValues) -> Identity {
    Identity {
        program: job.program.hash(),
        vary,
        params: about.parameters,
        code: about.code,
        start: job.start.digest(),
        policy: entry.policy.clone(),
        horizon: job.horizon(),
        early_stop: job.early_stop,
        repetition: job.repetition,
        drawn_for: job.drawn_for(),
    }
}

/// Runs a rollout into its folder, or resumes an interrupted one; returns the reason if it is stopped.
fn run(
    job: &Job<'_>,
    folder: &Path,
    identity: &Identity,
    listen: &mut dyn FnMut(Event),
) -> Result<Result<Rollout, StopReason>, BenchError> {
    if job.interrupt.is_raised() {
        return Ok(Err(StopReason::Interrupted));
    }
    let failed = |error: RunError| BenchError::Run {
        place: folder.display().to_string(),
        error,
    };
    let open = if folder.join(RECORD_FILE).is_file() {
        RunFolder::reopen(folder)
    } else {
        RunFolder::create(folder)
    };
    let open = open.map_err(failed)?;
    let rollout::Ended { report, took, .. } = match rollout::run(job, open, listen) {
        // Nobody lays a cloth for a program that was asked to stop.
        Err(RunError::World(WorldError::Start { .. } | WorldError::Interrupted))
            if job.interrupt.is_raised() =>
        {
            return Ok(Err(StopReason::Interrupted));
        }
        done => done.map_err(failed)?,
    };
    match report.outcome {
        Outcome::Interrupted => return Ok(Err(StopReason::Interrupted)),
        Outcome::BudgetExhausted => return Ok(Err(StopReason::Capped)),
        _ => {}
    }
    let mut refusals = [Fault::NotAuthorised, Fault::QuotaExhausted].into_iter();
    let named = refusals.find(|fault| took.faults.contains_key(fault));
    let found = record::find(folder, identity);
    let folder = folder.to_owned();
    match (report.outcome, named, found) {
        (Outcome::ModelFailed, Some(fault), _) => Err(BenchError::Refused(folder, fault)),
        (_, _, FolderContents::Finished(rollout)) => Ok(Ok(*rollout)),
        (_, _, FolderContents::Other(why)) => Err(BenchError::Other(folder, why)),
        (_, _, FolderContents::Unfinished) => Err(BenchError::Lost(folder)),
    }
}
