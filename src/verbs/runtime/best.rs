//! `fabc best`: the best that any answers to a task could do, beside what policies do.
//!
//! `fab_agent::best` searches. This module lays starts, runs the policies of the other rows, and reports.

mod report;
mod rows;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources::{self, TaskArguments};
use crate::verbs::runtime::run::say_pictures;
use crate::verbs::runtime::setting::worlds::{self, WorldChoice};
use crate::verbs::runtime::setting::{self, StartArguments};
use crate::verbs::runtime::sim::{ThreadArguments, threads};
use clap::{Args, ValueHint};
use fab_agent::best::{self, Aim, Limits, Search};
use fab_agent::examples::Examples;
use fab_agent::policy::Expert;
use fab_agent::rollout::Job;
use fab_model::calls::Budget;
use report::BestReport;
use rows::Row;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The most trials. The states of a search of that size fit in memory.
const MOST_TRIALS: i64 = 1_000_000;

/// Arguments of `best`.
#[derive(Args)]
pub struct BestArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    #[command(flatten)]
    pub start: StartArguments,
    /// Where actions are tried: `sim`, or `exec:"CMD ARG..."`, a program of yours that repeats and knows its particles.
    #[arg(long, value_name = "WORLD", default_value = "sim")]
    pub world: WorldChoice,
    /// The most steps; default: as many as the task allows.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100))]
    pub horizon: Option<u32>,
    /// The most actions that are tried.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=MOST_TRIALS))]
    pub trials: u32,
    /// How long the command may take; the rollouts beside the best are always finished.
    #[arg(long, value_name = "N", default_value_t = 110)]
    pub seconds: u32,
    /// Draws the order of actions that no expert ranks, pixels of masks, and the actions of the random policy.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    pub seed: u64,
    #[command(flatten)]
    pub threads: ThreadArguments,
    /// Where the rollouts beside the best are written; default: the next free runs/best-TASK-NNNN.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Lays the start, plays the rows beside the best, searches, and reports.
pub fn run(arguments: &BestArguments, io: &Io) -> Result<Exit, Failure> {
    let until = Instant::now().checked_add(Duration::from_secs(arguments.seconds.into()));
    let declared = sources::compile_task(&arguments.task, io)?;
    let beside = sources::folder_of(&arguments.task.file);
    let examples = Examples::load(&declared, &beside)?;
    let interrupt = io.interrupt()?;
    let world_of = |program: &_| match &arguments.world {
        WorldChoice::Program(command) => worlds::external(command, program, None, &interrupt),
        _ => setting::world(program),
    };
    if arguments.world == WorldChoice::Arm {
        return Err(Failure::usage(
            "an arm cannot take an action back: search in `--world sim`, or in a program that repeats",
        ));
    }
    let first = world_of(&declared)?;
    let start = &arguments.start;
    let start = setting::start(&declared, &beside, start, first.as_ref(), &interrupt, io)?;
    drop(first);
    let program = setting::fitted(&arguments.task, &declared, &start, io)?;
    let make_world = || world_of(&program);
    let make_expert_world = || setting::world(&program);
    let mut shown = make_expert_world()?;
    shown.reset(&start)?;
    let subgoals = setting::subgoals(&declared, &beside, shown.as_mut(), &interrupt)?;
    say_pictures(&subgoals, &arguments.task.file, io);
    let out = setting::out_folder(
        arguments.out.as_deref(),
        &format!("best-{}", declared.title().replace('/', "-")),
    )?;
    let job = Job {
        program: &program,
        start: &start,
        subgoals: &subgoals,
        examples: &examples,
        make_policy: &Expert,
        budget: &Budget::default(),
        make_world: &make_world,
        make_expert_world: &make_expert_world,
        cache: &setting::cache_or_beside(&out, io),
        interrupt: &interrupt,
        horizon: Some(arguments.horizon.unwrap_or(program.horizon)),
        early_stop: true,
        operator: None,
        repetition: 0,
        start_number: None,
    };
    let limits = Limits {
        trials: arguments.trials,
        until,
        seed: arguments.seed,
        threads: threads(&arguments.threads),
    };
    let aim = Aim::of(&job).map_err(setting::unfit_usage)?;
    let (policies, hint) = rows::play(&job, &limits, &aim, &out, io)?;
    let search = Search {
        job: &job,
        limits,
        hint: &hint,
        progress: &|trials| io.progress(&format!("{trials} of {} trials", arguments.trials)),
    };
    let found = best::search(&search, &aim)?;
    io.progress("");
    let mut best = Row {
        name: "best",
        oracle: true,
        ..Row::default()
    };
    if let Some(value) = found.value {
        best.add(value, None, program.goal.as_ref());
    }
    let mut rows = vec![best];
    rows.extend(policies);
    let report = BestReport::new(&program, &start, &found, &rows, &out);
    io.either(arguments.json, &report, || report.text());
    Ok(if interrupt.is_raised() {
        Exit::Interrupted
    } else if report.goal_missed {
        Exit::Unreached
    } else {
        Exit::Done
    })
}
