//! `fabc bench`: a suite of many rollouts, and its table.
//!
//! `fab_bench` defines suites, runs them and computes their figures. This module finds files, compiles tasks, and
//! prints and writes tables.

mod prepare;
mod report;
mod suites;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::estimate::{self, Asking};
use crate::verbs::runtime::events::EventArguments;
use crate::verbs::runtime::operator::TerminalOperator;
use crate::verbs::runtime::run::exit_of as exit_of_rollout;
use crate::verbs::runtime::run::report::so_far;
use crate::verbs::runtime::setting;
use crate::verbs::runtime::setting::arm::{ArmArguments, ArmMode};
use crate::verbs::runtime::setting::model_arguments::{
    ModelArguments, PolicyArguments, SpendArguments,
};
use crate::verbs::runtime::setting::models::{self, Answering};
use crate::verbs::runtime::setting::policies::Deciding;
use crate::verbs::runtime::setting::worlds::{self, WorldChoice};
use clap::{Args, ValueHint};
use fab_agent::rollout::FirstQuestion;
use fab_arm::settings::{DriverKind, Settings};
use fab_bench::on_arm::{Cloths, OnArm};
use fab_bench::play::{self, Played, Results, StopReason};
use fab_bench::suite::Suite;
use fab_bench::{Answers, Bench, Entry, OtherWorld, first_questions_of, rows};
use fab_program::Program;
use fab_providers::estimate::Estimate;
use fab_providers::remote::settings::Parameter;
use fab_world::{About, ExternalWorld, SimulatedWorld, World};
use prepare::{DecidingBy, named_by};
use report::BenchReport;
use std::collections::BTreeMap;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Instant;

/// The most rollouts in parallel.
const MAX_JOBS: i64 = 256;

/// The least rollouts in parallel if providers are asked.
const JOBS_WITH_PROVIDERS: usize = 8;

#[derive(Args)]
pub struct BenchArguments {
    /// A suite of tasks/suites by its name, or the path of a .toml file.
    #[arg(value_name = "SUITE")]
    pub suite: String,
    /// Who decides in methods of the suite that do not say.
    #[command(flatten)]
    pub policy: PolicyArguments,
    /// Who answers in methods of the suite that do not say.
    #[command(flatten)]
    pub model: ModelArguments,
    #[command(flatten)]
    pub spend: SpendArguments,
    /// Recorded starts in place of the suite's: a folder with manifest.json, or of .npy files with descriptions.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub starts: Option<PathBuf>,
    /// Rollouts per start of a model that varies; default: as the suite says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: Option<u32>,
    /// Share the answer to an equal question over all starts of a repeat, which costs less: the table says so, and its
    /// intervals are over clusters of starts without a common answer. Default: every start asks anew.
    #[arg(long)]
    pub share_answers: bool,
    /// Rollouts side by side; default: one per core, 8 or more with providers. The figures do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MAX_JOBS))]
    pub jobs: Option<u16>,
    /// Only the first N starts of each task.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Where run folders and tables go; rollouts that are finished there are not run again. Default: the next free runs/bench-SUITE-NNNN.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Only part I of N of the starts, counted from 1; with one `--out`, the last call may omit it.
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Where rollouts are carried out: `sim`, `arm` (on an arm one at a time), or `exec:"CMD ARG..."`, a program of yours.
    #[arg(long, value_name = "WORLD", default_value = "sim")]
    pub world: WorldChoice,
    #[command(flatten)]
    pub arm: ArmArguments,
    /// Ask after each rollout whether the task was reached, and if not, why; rollouts then run one at a time. Default: with
    /// a real arm, unless `--confirm none` is given or stdin is not a terminal.
    #[arg(long, conflicts_with = "jobs")]
    pub operator: bool,
    #[command(flatten)]
    pub events: EventArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    pub part: u32,
    pub of: u32,
}

fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/');
    let parts = parts.and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
    let shard = parts.map(|(part, of)| Shard { part, of });
    let shard = shard.filter(|it| (1..=it.of).contains(&it.part));
    shard.ok_or_else(|| "write a part and how many there are, such as 1/3, 2/3 and 3/3".to_owned())
}

pub fn run(arguments: &BenchArguments, io: &Io) -> Result<Exit, Failure> {
    let begun = Instant::now();
    arguments.arm.check_world(&arguments.world)?;
    let found = suites::find(&arguments.suite)?;
    let mut suite = found.suite;
    let mut omitted = arguments.model.reach.omitted();
    suite.structured &= !omitted.any(|it| it == Parameter::Schema);
    if suite.vary.is_some() && arguments.world != WorldChoice::Sim {
        return Err(Failure::environment(format!(
            "the suite varies its worlds (`[vary]`), which only the bundled simulator can, not `--world {}`: leave the option out, or run a suite without that table",
            arguments.world
        )));
    }
    let arm = match arguments.world {
        WorldChoice::Arm => Some(check_arm(arguments, &suite, io)?),
        _ => None,
    };
    let asks_operator = |(_, _, settings): &(Cloths, About, Settings)| {
        setting::arm::has_operator(&arguments.arm, settings, io)
    };
    let has_operator = arguments.operator || arm.as_ref().is_some_and(asks_operator);
    let interrupt = io.interrupt()?;
    let deciding = prepare::deciding(&suite, arguments, &interrupt, io)?;
    let mut answering = deciding.values().filter_map(Deciding::answering);
    if !arguments.share_answers && answering.any(Answering::shares_answers) {
        return Err(Failure::environment(
            "the replayed run holds one answer for all starts, and not one for each: `--share-answers` replays it so, and the table says so",
        ));
    }
    let budget = models::budget(&arguments.spend, &interrupt);
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let threads = match arguments.jobs {
        _ if arguments.operator => 1,
        Some(jobs) => usize::from(jobs),
        // Most of the time is spent waiting for a provider.
        None if asks_a_provider(&deciding) => cores.max(JOBS_WITH_PROVIDERS),
        None => cores,
    };
    let prepared = prepare::prepare(&suite, &found.folder, arguments, io)?;
    let out = if arguments.spend.estimate {
        PathBuf::from("runs")
    } else {
        setting::out_folder(arguments.out.as_deref(), &format!("bench-{}", found.name))?
    };
    let cache = setting::cache_or_beside(&out, io);
    let entries = prepare::entries(&suite, &prepared, &deciding, arguments, &interrupt, io)?;
    let make_arm_world = |program: &Program, folder: &Path| {
        let (arm, folder) = (&arguments.arm, folder.to_owned());
        setting::arm::world(program, arm, ArmMode::Execute, Some(&folder), io)
    };
    let make_look = |program: &Program| setting::arm::look(program, &arguments.arm);
    let world_command = match &arguments.world {
        WorldChoice::Program(command) => Some(command),
        WorldChoice::Sim | WorldChoice::Arm => None,
    };
    let commands = deciding.values().filter_map(Deciding::command);
    for command in commands.chain(world_command) {
        io.talk(&format!("each rollout that asks for it starts `{command}`"));
    }
    let make_elsewhere;
    let elsewhere = match world_command.zip(prepared.first()) {
        Some((command, first)) => {
            let Program { camera, picker, .. } = &first.task.program;
            let world = ExternalWorld::start(command, camera, *picker, None, &interrupt)?;
            if !world.hello().particles {
                Cloths::ByHand.check(&suite)?;
            }
            make_elsewhere = |program: &Program, folder: &Path| {
                worlds::external(command, program, Some(folder), &interrupt)
            };
            Some(OtherWorld {
                about: About::of(&world),
                repeats: world.repeats(),
                make_world: &make_elsewhere,
            })
        }
        None => None,
    };
    let terminal = TerminalOperator(io);
    // An estimate plays nothing, and must not empty the file of an earlier suite.
    let listening = if arguments.spend.estimate {
        EventArguments::default()
    } else {
        arguments.events.clone()
    };
    let events = listening.open(arguments.json, io)?;
    let bench = Bench {
        suite: &suite,
        tasks: prepared.into_iter().map(|it| it.task).collect(),
        entries,
        make_world: &|program, values| {
            let world = SimulatedWorld::of(program)?;
            Ok(Box::new(world.varied(values, &program.camera)))
        },
        arm: arm.map(|(cloths, about, _)| OnArm {
            about,
            cloths,
            make_world: &make_arm_world,
            make_look: &make_look,
        }),
        elsewhere,
        out: out.clone(),
        threads,
        answers: if arguments.share_answers {
            Answers::Shared
        } else {
            Answers::PerStart
        },
        cache: &cache,
        budget: &budget,
        operator: if has_operator { Some(&terminal) } else { None },
        interrupt: &interrupt,
        listen: &|run, event| events.write(run, event),
    };
    let mut questions = Vec::new();
    if asks_a_provider(&deciding) || arguments.spend.estimate {
        questions = first_questions_of(&bench)?;
    }
    for (entry, questions) in bench.entries.iter().zip(&questions) {
        if let Some(answering) = answering_of(&deciding, entry) {
            answering.check(questions)?;
        }
    }
    if arguments.spend.estimate {
        return Ok(foresee(&bench, &questions, &deciding, arguments, io));
    }
    io.talk(&report::plan(&found.name, &bench, arguments.shard));
    let results = play::play(&bench, &|what, done, of| {
        let spent = so_far(&budget.spent());
        io.progress(&format!("{done} of {of} {what}{spent}"));
    });
    io.progress("");
    let results = results?;
    let rows = rows::rows(&bench, &results);
    let report = BenchReport {
        name: &found.name,
        bench: &bench,
        results: &results,
        rows: &rows,
        wall_s: begun.elapsed().as_secs_f64(),
    };
    let document = report.document();
    report.write(&document, &out)?;
    events.result(arguments.json, &document, || report.text())?;
    io.talk(&report.summary());
    Ok(exit_of(&results))
}

/// Checks first of all that the arm can run the suite; returns who lays cloths on its table, its world, and its settings.
fn check_arm(
    arguments: &BenchArguments,
    suite: &Suite,
    io: &Io,
) -> Result<(Cloths, About, Settings), Failure> {
    if let Some(jobs) = arguments.jobs.filter(|jobs| *jobs != 1) {
        return Err(Failure::usage(format!(
            "`--jobs {jobs}` is for the simulator: an arm carries rollouts out one at a time"
        )));
    }
    let robot = arguments.arm.robot();
    let cloths = match Settings::load(robot)?.driver {
        DriverKind::Simulated => Cloths::Simulated,
        DriverKind::Kinova | DriverKind::Trajectory | DriverKind::Ros2 => Cloths::ByHand,
    };
    cloths.check(suite)?;
    let files = setting::arm::check(&arguments.arm, ArmMode::Execute, io)?;
    Ok((cloths, files.about, files.settings))
}

fn asks_a_provider(deciding: &DecidingBy) -> bool {
    let mut answering = deciding.values().filter_map(Deciding::answering);
    answering.any(Answering::asks_a_provider)
}

/// Returns the models of an entry's policy, if it asks any.
fn answering_of<'d>(deciding: &'d DecidingBy, entry: &Entry<'_>) -> Option<&'d Answering> {
    deciding.get(&named_by(entry.method))?.answering()
}

fn foresee(
    bench: &Bench<'_>,
    questions: &[Vec<FirstQuestion>],
    deciding: &DecidingBy,
    arguments: &BenchArguments,
    io: &Io,
) -> Exit {
    // Without the cache, every method buys its own answers.
    let is_kept = !arguments.model.reach.no_cache;
    // The questions of earlier methods, whose answers the later ones share: by task, model and question, the most repeats.
    let mut shared: BTreeMap<(usize, String, String), u32> = BTreeMap::new();
    let entries = bench.entries.iter().zip(questions);
    let parts = entries.filter_map(|(entry, questions)| {
        let program = entry.programs.values().next()?;
        let answering = answering_of(deciding, entry)?;
        let starts = bench.tasks[entry.task].starts.len() as u64;
        let horizon = bench.suite.horizons.last().copied();
        // A question may quote the answers before it, which are the same only if their questions are.
        let mut all_shared = entry.repeats;
        // For each question, how many rollouts are likely to ask it anew.
        let fresh = questions.iter().map(|FirstQuestion { request, .. }| {
            let model = answering
                .remote(request.role)
                .map(|it| it.profile().title());
            let key = (entry.task, model.unwrap_or_default(), request.key());
            let before = shared.entry(key).or_default();
            if !is_kept {
                *before = 0;
            }
            all_shared = all_shared.min(*before);
            *before = entry.repeats.max(*before);
            // A varied world may look the same at first, and differs after the first action.
            let is_varied = entry.variation.name().is_some();
            let n_shared = if is_varied { 0 } else { all_shared };
            starts * u64::from(entry.repeats - n_shared)
        });
        let fresh: Vec<u64> = fresh.collect();
        let asking = Asking {
            program,
            questions,
            answering,
            horizon: horizon.unwrap_or(program.horizon),
            rollouts: starts * u64::from(entry.repeats),
            fresh: &fresh,
        };
        Some(estimate::estimate(&asking, io))
    });
    estimate::say(&Estimate::total(parts), arguments.json, io);
    Exit::Done
}

/// A suite succeeds when its rollouts have ended, however they did; only if none could be played, the environment failed.
fn exit_of(results: &Results) -> Exit {
    let has_failed =
        |it: &Played| exit_of_rollout(it.rollout.report.outcome, None, None) == Exit::Environment;
    let all_failed = !results.rollouts.is_empty() && results.rollouts.iter().all(has_failed);
    match results.stopped {
        Some(StopReason::Interrupted) => Exit::Interrupted,
        Some(StopReason::Capped) => Exit::Unreached,
        // The same exit code as for the rollout that ended like this.
        Some(StopReason::Arm) => Exit::Environment,
        None if !results.cut_off.is_empty() => Exit::Unreached,
        None if all_failed => Exit::Environment,
        None => Exit::Done,
    }
}
