//! `fabc best`: the best that any answers to a task could do in the simulator, beside what policies do.
//!
//! `fab_agent::best` searches. This module lays starts, runs the policies of the other rows, and reports.

mod report;
mod rows;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources::{self, TaskArguments};
use crate::verbs::runtime::run::{prepare, say_pictures};
use crate::verbs::runtime::setting::worlds::WorldChoice;
use crate::verbs::runtime::setting::{self, StartArguments};
use crate::verbs::runtime::sim::parallel::{ThreadArguments, threads};
use clap::{Args, ValueHint};
use fab_agent::best::journal::{Identity, TrialJournal};
use fab_agent::best::{self, BestError, Limits, Measure, Search, unless_stopped};
use fab_agent::examples::Examples;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_program::Program;
use fab_world::{SimulatedWorld, World, WorldError};
use report::{AtStart, BestReport};
use rows::Row;
use std::path::{Path, PathBuf};

/// The most trials of a start. The states of a search of that size fit in memory.
const MOST_TRIALS: i64 = 1_000_000;

/// Arguments of `best`.
#[derive(Args)]
pub struct BestArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    #[command(flatten)]
    pub start: StartArguments,
    /// How many starts, with the seeds from `--start` (default: 0) on; several get means with 95 % intervals.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub starts: u32,
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
    /// Where actions are tried: only `sim`, the bundled simulator, can try one action and take it back.
    #[arg(long, value_name = "WORLD", default_value = "sim")]
    pub world: WorldChoice,
    /// Where trials and rollouts are kept; what is finished there is not done again. Default: the next free
    /// runs/best-TASK-NNNN.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Searches, compares, and reports.
pub fn run(arguments: &BestArguments, io: &Io) -> Result<Exit, Failure> {
    if arguments.world != WorldChoice::Sim {
        return Err(Failure::usage(format!(
            "`--world {}`: the best is searched by trying actions and taking them back, which only `sim` can; leave the option out",
            arguments.world
        )));
    }
    let program = sources::compile_task(&arguments.task, io)?;
    let measure = Measure::of(&program).map_err(failure)?;
    let beside = sources::folder_of(&arguments.task.file);
    let examples = Examples::load(&program, &beside).map_err(Failure::environment)?;
    let interrupt = io.interrupt()?;
    let starts = starts(arguments)?;
    let out = setting::out_folder(
        arguments.out.as_deref(),
        &format!("best-{}", program.title().replace('/', "-")),
    )?;
    let searching = Searching {
        arguments,
        declared: &program,
        beside: &beside,
        examples: &examples,
        out: &out,
        cache: &setting::cache_or_beside(&out, io),
        interrupt: &interrupt,
        io,
    };
    let (mut found, mut rows) = (Vec::new(), Vec::new());
    for (number, start) in starts.iter().enumerate() {
        let searched = searching.search(number as u32, start);
        io.progress("");
        match searched {
            Ok((at, beside)) => {
                found.push(at);
                rows.push(beside);
            }
            // What was found at the starts before is printed.
            Err(_) if interrupt.is_raised() && !found.is_empty() => {}
            Err(failure) => return Err(failure),
        }
        if interrupt.is_raised() {
            break;
        }
    }
    let report = BestReport::new(arguments, &program, measure, found, &rows, &out);
    io.result(arguments.json, &report);
    Ok(match interrupt.is_raised() {
        true => Exit::Interrupted,
        false if report.goal_missed => Exit::Unreached,
        false => Exit::Done,
    })
}

/// Returns what is known of each start before it is laid.
fn starts(arguments: &BestArguments) -> Result<Vec<StartArguments>, Failure> {
    if arguments.starts == 1 {
        return Ok(vec![arguments.start.clone()]);
    }
    let first = match arguments.start.start.as_deref().map(str::parse::<u64>) {
        None => 0,
        Some(Ok(seed)) => seed,
        Some(Err(_)) => {
            return Err(Failure::usage(
                "`--starts` counts seeds from that of `--start`, which names a file here: give a seed, or leave one of them out",
            ));
        }
    };
    Ok(setting::seeds(first, arguments.starts)?
        .map(|seed| StartArguments {
            start: Some(seed.to_string()),
            frame: arguments.start.frame.clone(),
        })
        .collect())
}

/// What the searches of all starts share.
struct Searching<'a> {
    arguments: &'a BestArguments,
    declared: &'a Program,
    beside: &'a Path,
    examples: &'a Examples,
    out: &'a Path,
    cache: &'a Cache,
    interrupt: &'a Interrupt,
    io: &'a Io,
}

impl Searching<'_> {
    /// Lays a start, plays the rows beside the best, and searches; fails if it is interrupted before the first trial.
    fn search(&self, number: u32, start: &StartArguments) -> Result<(AtStart, Vec<Row>), Failure> {
        let Searching {
            arguments,
            declared,
            beside,
            interrupt,
            io,
            ..
        } = *self;
        let world = setting::world(declared).map_err(Failure::environment)?;
        let start = setting::start(declared, beside, start, world.as_ref(), interrupt, io)?;
        let program = setting::fitted(&arguments.task, declared, &start, io)?;
        let folder = self.out.join(format!("start-{}", number + 1));
        std::fs::create_dir_all(&folder).map_err(|error| Failure::unwritable(&folder, error))?;
        let make_world = || SimulatedWorld::of(&program);
        let make_boxed = || -> Result<Box<dyn World>, WorldError> { Ok(Box::new(make_world()?)) };
        let subgoals = prepare(declared, &start, beside, &make_boxed, interrupt)?;
        let subgoals = subgoals.ok_or_else(Failure::interrupted)?;
        if number == 0 {
            say_pictures(&subgoals, self.examples, &arguments.task.file, io);
        }
        let world = make_world().map_err(Failure::environment)?;
        let identity = Identity {
            program: program.hash(),
            start: start.digest(),
            params: world.parameters(),
            code: world.code(),
            subgoals: subgoals.digest(),
        };
        let journal = TrialJournal::open(&folder, &identity).map_err(failure)?;
        let of = format!("start {} of {}", number + 1, arguments.starts);
        let progress = |trials: u32| {
            io.progress(&format!("{of}: {trials} of {} trials", arguments.trials));
        };
        let search = Search {
            program: &program,
            start: &start,
            subgoals: &subgoals,
            make_world: &make_world,
            cache: self.cache,
            horizon: arguments.horizon,
            limits: Limits {
                trials: arguments.trials,
                beam: arguments.beam,
                seed: arguments.seed,
                threads: threads(&arguments.threads),
            },
            hints: &[],
            journal: Some(&journal),
            interrupt,
            progress: &progress,
        };
        let playing = rows::Playing {
            search: &search,
            examples: self.examples,
            folder: &folder,
            io,
        };
        let (policies, hints) = playing.policies(&of)?;
        let hinted = Search {
            hints: &hints,
            ..search
        };
        let found = unless_stopped(best::search(&hinted)).map_err(failure)?;
        let found = found.ok_or_else(Failure::interrupted)?;
        let mut rows = vec![playing.best(&found)?];
        rows.extend(policies);
        Ok((AtStart::new(&program, &start, found), rows))
    }
}

fn failure(error: BestError) -> Failure {
    match error {
        BestError::Aimless { .. } => Failure::usage(error.to_string()),
        error => Failure::environment(error),
    }
}
