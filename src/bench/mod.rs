//! `fabc bench`: a suite of many rollouts, and its table.
//!
//! What a suite is, how it is carried out and what is said of it is `fab_bench`; here files are found, tasks
//! compiled, and tables printed and written.

mod on_arm;
mod prepare;
mod report;
mod suites;

use crate::cli::bench::BenchArguments;
use crate::estimate::{self, Asking};
use crate::exit::{Exit, Failure};
use crate::operator::Terminal;
use crate::setting::arm::ArmMode;
use crate::setting::models::{self, Answering};
use crate::setting::policies::Deciding;
use crate::setting::worlds::{self, WorldChoice};
use crate::{output, setting};
use fab_agent::outcome::Outcome;
use fab_agent::rollout::FirstQuestion;
use fab_base::cache::Cache;
use fab_bench::on_arm::{Cloths, OnArm};
use fab_bench::play;
use fab_bench::play::{Phase, Results, Stop};
use fab_bench::{Bench, BenchError, Elsewhere, Entry, first_questions_of, rows};
use fab_model::calls::Budget;
use fab_program::Program;
use fab_providers::estimate::Estimate;
use fab_world::{About, ExternalWorld, World};
use prepare::{DecidingBy, named_by};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Instant;

/// Carries out a suite and reports it.
pub fn run(arguments: &BenchArguments) -> Result<Exit, Failure> {
    let begun = Instant::now();
    let found = suites::find(&arguments.suite)?;
    let suite = suites::narrowed(found.suite, arguments.variant.as_deref());
    let arm = on_arm::check(arguments, &suite)?;
    let has_operator = arguments.operator
        || arm
            .as_ref()
            .is_some_and(|arm| setting::arm::has_operator(&arguments.arm, &arm.settings));
    let interrupt = setting::interrupt()?;
    let deciding = prepare::deciding(
        &suite,
        &arguments.policy,
        &arguments.model,
        arguments.spend.purpose(),
        &interrupt,
    )?;
    let recorder = match arguments.spend.estimate {
        true => None,
        false => models::recorder(&arguments.spend)?,
    };
    let budget = models::budget(&arguments.spend);
    let threads = match arguments.jobs {
        _ if arguments.operator => 1,
        Some(jobs) => usize::from(jobs),
        None => usual_jobs(&deciding),
    };
    let prepared = prepare::prepare(&suite, &found.folder, arguments, threads)?;
    let out = match arguments.spend.estimate {
        true => PathBuf::from("runs"),
        false => out_folder(arguments.out.as_deref(), &found.name)?,
    };
    let cache = cache(&out);
    let Some(entries) = prepare::entries(&suite, &prepared, &deciding, arguments, &interrupt)?
    else {
        return Err(Failure::interrupted());
    };
    let make_arm_world = |program: &Program, folder: &Path| {
        setting::arm::world(
            program,
            &arguments.arm,
            ArmMode::Execute,
            Some(&folder.to_owned()),
        )
    };
    let make_look = |program: &Program| setting::arm::look(program, &arguments.arm);
    let world_command = match &arguments.world {
        WorldChoice::Program(command) => Some(command),
        WorldChoice::Sim | WorldChoice::Jaco => None,
    };
    for command in deciding
        .values()
        .filter_map(Deciding::command)
        .chain(world_command)
    {
        output::talk(&format!("each rollout that asks for it starts `{command}`"));
    }
    let make_elsewhere;
    let elsewhere = match world_command.zip(prepared.first()) {
        Some((command, first)) => {
            let camera = &first.task.program.camera;
            let picker = first.task.program.picker;
            let world = ExternalWorld::start(command, camera, picker, None, &interrupt);
            let world = world.map_err(worlds::failure)?;
            if !world.hello().particles {
                Cloths::ByHand.check(&suite).map_err(Failure::environment)?;
            }
            make_elsewhere = |program: &Program, folder: &Path| {
                worlds::external(command, program, Some(folder), &interrupt)
            };
            Some(Elsewhere {
                about: About::of(&world),
                repeats: world.repeats(),
                make_world: &make_elsewhere,
            })
        }
        None => None,
    };
    let bench = Bench {
        suite: &suite,
        tasks: prepared.into_iter().map(|it| it.task).collect(),
        entries,
        make_world: &setting::world,
        arm: arm.map(|arm| OnArm {
            about: arm.about,
            cloths: arm.cloths,
            make_world: &make_arm_world,
            make_look: &make_look,
        }),
        elsewhere,
        out: out.clone(),
        threads,
        cache: &cache,
        budget: &budget,
        recorder: recorder.as_ref(),
        operator: has_operator.then_some(&Terminal),
        interrupt: &interrupt,
    };
    let asks = asks_a_provider(&deciding) || arguments.spend.estimate;
    let questions = match asks {
        true => first_questions_of(&bench).map_err(failure)?,
        false => Vec::new(),
    };
    for (entry, questions) in bench.entries.iter().zip(&questions) {
        if let Some(answering) = answering_of(&deciding, entry) {
            answering.check(questions)?;
        }
    }
    if arguments.spend.estimate {
        return Ok(foresee(&bench, &questions, &deciding, arguments.json));
    }
    output::talk(&report::plan(&found.name, &bench, arguments.shard));
    let results = play::play(&bench, &|phase, done, of| show(phase, done, of, &budget));
    output::progress("");
    let results = results.map_err(failure)?;
    let rows = rows::rows(&bench, &results);
    let report = report::Report {
        name: &found.name,
        bench: &bench,
        results: &results,
        rows: &rows,
        wall_s: begun.elapsed().as_secs_f64(),
    };
    report.write(&out)?;
    if arguments.json {
        output::json(&report.json());
    } else {
        output::data(&report.text());
    }
    output::talk(&report.told());
    Ok(exit_of(&results))
}

/// Returns how many rollouts run side by side by default: one per core, and more where most of the time is a
/// provider's.
fn usual_jobs(deciding: &DecidingBy) -> usize {
    const WITH_PROVIDERS: usize = 8;
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    match asks_a_provider(deciding) {
        true => cores.max(WITH_PROVIDERS),
        false => cores,
    }
}

fn asks_a_provider(deciding: &DecidingBy) -> bool {
    let mut answering = deciding.values().filter_map(Deciding::answering);
    answering.any(Answering::asks_a_provider)
}

/// Returns the models of an entry's policy, where it asks any.
fn answering_of<'d>(deciding: &'d DecidingBy, entry: &Entry<'_>) -> Option<&'d Answering> {
    deciding.get(&named_by(entry.method))?.answering()
}

/// Says what the suite would ask and cost.
fn foresee(
    bench: &Bench<'_>,
    questions: &[Vec<FirstQuestion>],
    deciding: &DecidingBy,
    json: bool,
) -> Exit {
    let entries = bench.entries.iter().zip(questions);
    let parts = entries.filter_map(|(entry, questions)| {
        let program = entry.programs.values().next()?;
        let starts = bench.tasks[entry.task].starts.len() as u64;
        Some(estimate::estimate(&Asking {
            program,
            questions,
            answering: answering_of(deciding, entry)?,
            horizon: bench
                .suite
                .horizons
                .last()
                .copied()
                .unwrap_or(program.horizon),
            rollouts: starts * u64::from(entry.repeats),
        }))
    });
    estimate::say(&Estimate::total(parts), json);
    Exit::Done
}

fn failure(error: BenchError) -> Failure {
    Failure::environment(error)
}

/// Makes the folder of a suite's runs.
fn out_folder(named: Option<&Path>, suite: &str) -> Result<PathBuf, Failure> {
    let cannot = |path: &Path, error: std::io::Error| {
        Failure::environment(format!(
            "cannot make the folder `{}`: {error}",
            path.display()
        ))
    };
    if let Some(path) = named {
        std::fs::create_dir_all(path).map_err(|error| cannot(path, error))?;
        return Ok(path.to_owned());
    }
    let parent = Path::new("runs");
    std::fs::create_dir_all(parent).map_err(|error| cannot(parent, error))?;
    for number in 1..=9999u32 {
        let path = parent.join(format!("bench-{suite}-{number:04}"));
        match std::fs::create_dir(&path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(cannot(&path, error)),
        }
    }
    Err(Failure::environment(format!(
        "`{}` holds 9999 runs of `{suite}` already; name a folder with `--out`",
        parent.display()
    )))
}

/// Opens the user's cache, else one beside the runs: without any, every rollout would simulate its own experts.
fn cache(out: &Path) -> Cache {
    match setting::cache() {
        cache if cache.is_kept() => cache,
        _ => Cache::at(out.join("cache")),
    }
}

fn show(phase: Phase, done: usize, of: usize, budget: &Budget) {
    let what = match phase {
        Phase::Starts => "starts laid",
        Phase::Experts => "expert ends known",
        Phase::Rollouts => "rollouts finished",
    };
    let spent = budget.spent();
    let spent = match spent.calls {
        0 => String::new(),
        calls => format!(", {calls} calls, {}", spent.in_words()),
    };
    output::progress(&format!("{done} of {of} {what}{spent}"));
}

/// A suite is done when its rollouts have ended, however they did; only where none could even be played has
/// the environment failed.
fn exit_of(results: &Results) -> Exit {
    let failed = |outcome: Outcome| {
        matches!(
            outcome,
            Outcome::ModelFailed | Outcome::PolicyFailed | Outcome::WorldFailed
        )
    };
    match results.stopped {
        Some(Stop::Interrupted) => return Exit::Interrupted,
        Some(Stop::Capped) => return Exit::Unreached,
        // As that of the rollout that ended so.
        Some(Stop::ArmLeft) => return Exit::Environment,
        None if !results.cut_off.is_empty() => return Exit::Unreached,
        None => {}
    }
    let mut outcomes = results
        .rollouts
        .iter()
        .map(|played| played.rollout.report.outcome);
    if !results.rollouts.is_empty() && outcomes.all(failed) {
        return Exit::Environment;
    }
    Exit::Done
}
