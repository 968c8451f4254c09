//! `fabc best`: the best that any answers to a task could do in the simulator, beside what policies do.
//!
//! `fab_agent::best` searches. This module lays starts, runs the policies of the other rows, and reports.

mod report;
mod rows;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources;
use crate::sources::TaskArguments;
use crate::verbs::runtime::run::{prepare, say_pictures};
use crate::verbs::runtime::setting;
use crate::verbs::runtime::setting::StartArguments;
use crate::verbs::runtime::setting::worlds::WorldChoice;
use crate::verbs::runtime::sim::parallel::{ThreadArguments, threads};
use clap::Args;
use clap::ValueHint;
use fab_agent::best::journal::{Identity, TrialJournal};
use fab_agent::best::unoffered::{Unoffered, unoffered};
use fab_agent::best::{self, BestError, Found, Limits, Measure, Search, unless_stopped};
use fab_agent::examples::Examples;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_program::Program;
use fab_world::start::Start;
use fab_world::{SimulatedWorld, World, WorldError};
use report::Report;
use rows::Row;
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The most trials of a start. The states of a search of that size fit in memory.
const MOST_TRIALS: i64 = 1_000_000;

/// A start may take as many trials again, divided by this, of actions that are not offered.
const BEYOND: u32 = 2;

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
    /// The most states after as many actions that are gone on from.
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

/// What was found for one start.
pub struct AtStart {
    pub start: Start,
    pub program: Program,
    pub found: Found,
    pub unoffered: Unoffered,
    pub rows: Vec<Row>,
}

/// What there is of a start that was interrupted before anything was tried.
pub struct Unsearched {
    pub start: Start,
    /// What policies do there.
    pub rows: Vec<Row>,
}

/// How far a start got.
enum Searched {
    Found(Box<AtStart>),
    /// It was interrupted before.
    Not(Option<Unsearched>),
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
    let cache = setting::cache_or_beside(&out, io);
    let shared = Shared {
        arguments,
        declared: &program,
        measure,
        beside: &beside,
        examples: &examples,
        out: &out,
        cache: &cache,
        interrupt: &interrupt,
        io,
        searching: Cell::default(),
    };
    let world = setting::world(&program).map_err(Failure::environment)?;
    let mut all = Vec::new();
    let mut unsearched = None;
    for (number, start) in starts.iter().enumerate() {
        if interrupt.is_raised() && !all.is_empty() {
            break;
        }
        let laid = setting::start(&program, &beside, start, world.as_ref(), &interrupt, io);
        let start = match laid {
            // What was found from the starts before is printed.
            Err(_) if interrupt.is_raised() && !all.is_empty() => break,
            laid => laid?,
        };
        match shared.search(number, start)? {
            Searched::Found(found) => all.push(*found),
            Searched::Not(what) => {
                unsearched = what;
                break;
            }
        }
    }
    let report = Report {
        arguments,
        program: &program,
        measure,
        starts: &all,
        unsearched: unsearched.as_ref(),
        out: &out,
    };
    io.report(arguments.json, || report.json(), || report.text());
    let is_whole = all.len() == arguments.starts as usize;
    let stopped = interrupt.is_raised() || !is_whole;
    Ok(match (stopped, report.misses_goal()) {
        (true, _) => Exit::Interrupted,
        (false, true) => Exit::Unreached,
        (false, false) => Exit::Done,
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
    let seeds = (0..u64::from(arguments.starts)).map(|number| {
        let seed = first.checked_add(number).ok_or_else(|| {
            Failure::usage(format!("the seeds go beyond the largest one, {}", u64::MAX))
        })?;
        Ok(StartArguments {
            start: Some(seed.to_string()),
            frame: arguments.start.frame.clone(),
        })
    });
    seeds.collect()
}

/// What the searches of all starts share.
struct Shared<'a> {
    arguments: &'a BestArguments,
    declared: &'a Program,
    measure: Measure,
    beside: &'a Path,
    examples: &'a Examples,
    out: &'a Path,
    cache: &'a Cache,
    interrupt: &'a Interrupt,
    io: &'a Io,
    /// How long earlier starts were searched, without the rollouts beside them.
    searching: Cell<Duration>,
}

impl Shared<'_> {
    /// Searches one start, and plays the rows beside it.
    fn search(&self, number: usize, start: Start) -> Result<Searched, Failure> {
        let Shared {
            arguments,
            cache,
            interrupt,
            io,
            ..
        } = *self;
        let program = setting::fitted(&arguments.task, self.declared, &start, io)?;
        let folder = self.out.join(format!("start-{}", number + 1));
        std::fs::create_dir_all(&folder).map_err(|error| {
            Failure::environment(format!("cannot make `{}`: {error}", folder.display()))
        })?;
        let make_world = || SimulatedWorld::of(&program);
        let make_boxed = || -> Result<Box<dyn World>, WorldError> {
            Ok(Box::new(SimulatedWorld::of(&program)?))
        };
        let subgoals = prepare(self.declared, &start, self.beside, &make_boxed, interrupt)?;
        let Some(subgoals) = subgoals else {
            return Ok(Searched::Not(None));
        };
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
        let most = arguments.trials;
        let most_beyond = most / BEYOND;
        let unhinted = Search {
            program: &program,
            start: &start,
            subgoals: &subgoals,
            make_world: &make_world,
            cache,
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
            progress: &|_| {},
        };
        let (starts, before) = (arguments.starts, number as u32);
        let playing = rows::Playing {
            search: &unhinted,
            examples: self.examples,
            folder: &folder,
            io,
        };
        let of = format!("start {} of {starts}", before + 1);
        let (policies, hints) = playing.policies(self.measure, &of)?;
        // Each start counts with the most trials that it may take, so that the time left is hardly ever too short.
        let bar = Bar {
            io,
            begun: Instant::now(),
            before: self.searching.get(),
            of: u64::from(starts) * u64::from(most + most_beyond),
        };
        let of_start = |trials: u32, what: &str| {
            let done = u64::from(before) * u64::from(most + most_beyond) + u64::from(trials);
            bar.show(done, &format!("{of}: {what}"));
        };
        let progress = |trials: u32| of_start(trials, &format!("{trials} of {most} trials"));
        let progress_beyond = |trials: u32| {
            let what = format!("{trials} of {most_beyond} not offered");
            of_start(most + trials, &what);
        };
        let search = Search {
            hints: &hints,
            progress: &progress,
            ..unhinted
        };
        let searched = unless_stopped(best::search(&search));
        io.progress("");
        let Some((found, tree)) = searched.map_err(failure)? else {
            let rows = policies;
            return Ok(Searched::Not(Some(Unsearched { start, rows })));
        };
        let search = Search {
            progress: &progress_beyond,
            ..search
        };
        let tried = unoffered(&search, &tree, &found, most_beyond);
        io.progress("");
        let tried = tried.map_err(failure)?;
        drop(tree);
        self.searching
            .set(self.searching.get() + bar.begun.elapsed());
        let mut rows = vec![playing.best(&found)?];
        rows.extend(policies);
        Ok(Searched::Found(Box::new(AtStart {
            found,
            unoffered: tried,
            rows,
            start,
            program,
        })))
    }
}

/// How far the whole command is.
struct Bar<'a> {
    io: &'a Io,
    begun: Instant,
    /// How long earlier starts took.
    before: Duration,
    /// The most trials that it makes.
    of: u64,
}

impl Bar<'_> {
    /// Shows a bar, what is under way, and the most time that is left, on one line.
    fn show(&self, done: u64, what: &str) {
        const CELLS: usize = 20;
        let share = done as f64 / self.of.max(1) as f64;
        let full = (share * CELLS as f64) as usize;
        let spent = self.before + self.begun.elapsed();
        let left_s = spent.as_secs_f64() * (1.0 / share.max(1e-6) - 1.0);
        self.io.progress(&format!(
            "[{:-<CELLS$}] {what}, at most {} left",
            "#".repeat(full.min(CELLS)),
            report::duration(left_s)
        ));
    }
}

fn failure(error: BestError) -> Failure {
    match error {
        BestError::Aimless { .. } => Failure::usage(error.to_string()),
        error => Failure::environment(error),
    }
}
