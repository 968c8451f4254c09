//! `fabc best`: the best that any answers to a task could do in the simulator, beside what policies do.
//!
//! `fab_agent::best` searches. This module lays starts, runs the policies of the other rows, and reports.

mod report;
mod rows;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources::{self, TaskArguments};
use crate::verbs::runtime::run::say_pictures;
use crate::verbs::runtime::setting::{self, StartArguments};
use crate::verbs::runtime::sim::parallel::{ThreadArguments, threads};
use clap::{Args, ValueHint};
use fab_agent::best::journal::{Identity, TrialJournal};
use fab_agent::best::{self, BestError, Limits, Measure, Search, unless_stopped};
use fab_agent::examples::Examples;
use fab_world::{SimulatedWorld, World};
use report::BestReport;
use std::path::PathBuf;

/// The most trials of a start. The states of a search of that size fit in memory.
const MOST_TRIALS: i64 = 1_000_000;

/// Arguments of `best`.
#[derive(Args)]
pub struct BestArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    #[command(flatten)]
    pub start: StartArguments,
    /// The most steps; default: as many as the task allows.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100))]
    pub horizon: Option<u32>,
    /// The most actions that are tried for a start.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=MOST_TRIALS))]
    pub trials: u32,
    /// The most states that are kept after each action.
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub beam: u32,
    /// Draws the order of actions that no expert ranks, pixels of masks, and the actions of the random policy.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    pub seed: u64,
    #[command(flatten)]
    pub threads: ThreadArguments,
    /// Where trials and rollouts are kept; what is finished there is not done again. Default: the next free
    /// runs/best-TASK-NNNN.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Lays the start, plays the rows beside the best, searches, and reports.
pub fn run(arguments: &BestArguments, io: &Io) -> Result<Exit, Failure> {
    let declared = sources::compile_task(&arguments.task, io)?;
    Measure::of(&declared).map_err(failure)?;
    let beside = sources::folder_of(&arguments.task.file);
    let examples = Examples::load(&declared, &beside)?;
    let interrupt = io.interrupt()?;
    let world = setting::world(&declared)?;
    let start = &arguments.start;
    let start = setting::start(&declared, &beside, start, world.as_ref(), &interrupt, io)?;
    let program = setting::fitted(&arguments.task, &declared, &start, io)?;
    let out = setting::out_folder(
        arguments.out.as_deref(),
        &format!("best-{}", declared.title().replace('/', "-")),
    )?;
    let make_world = || SimulatedWorld::of(&program);
    let mut world = make_world()?;
    world.reset(&start)?;
    let subgoals = setting::subgoals(&declared, &beside, &mut world, &interrupt)?;
    say_pictures(&subgoals, &examples, &arguments.task.file, io);
    let identity = Identity {
        program: program.hash(),
        start: start.digest(),
        params: world.parameters(),
        code: world.code(),
        subgoals: subgoals.digest(),
    };
    let journal = TrialJournal::open(&out, &identity)?;
    let search = Search {
        program: &program,
        start: &start,
        subgoals: &subgoals,
        make_world: &make_world,
        cache: &setting::cache_or_beside(&out, io),
        horizon: arguments.horizon,
        limits: Limits {
            trials: arguments.trials,
            beam: arguments.beam,
            seed: arguments.seed,
            threads: threads(&arguments.threads),
        },
        hints: &[],
        journal: Some(&journal),
        interrupt: &interrupt,
        progress: &|trials| io.progress(&format!("{trials} of {} trials", arguments.trials)),
    };
    let playing = rows::Playing {
        search: &search,
        examples: &examples,
        folder: &out,
        io,
    };
    let (policies, hints) = playing.policies()?;
    let hinted = Search {
        hints: &hints,
        ..search
    };
    let found = unless_stopped(best::search(&hinted));
    io.progress("");
    let found = found?.ok_or_else(Failure::interrupted)?;
    let mut rows = vec![rows::Row::best(&found, program.goal.as_ref())];
    rows.extend(policies);
    let report = BestReport::new(&program, &start, found, rows, &out);
    io.result(arguments.json, &report);
    Ok(if interrupt.is_raised() {
        Exit::Interrupted
    } else if report.goal_missed {
        Exit::Unreached
    } else {
        Exit::Done
    })
}

fn failure(error: BestError) -> Failure {
    match error {
        BestError::Aimless { .. } => Failure::usage(error.to_string()),
        error => Failure::environment(error),
    }
}
