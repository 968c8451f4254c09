//! `fabc resume`: continues a rollout that was cut off or stopped.
//!
//! The rollout is replayed from its start with the recorded answers and must give the same result; from the first
//! unrecorded step on, it asks and executes as usual. So no question is asked twice, and a change of the task or the
//! simulator is noticed.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::events::EventArguments;
use crate::verbs::runtime::run::{self, Begun, RUN_FILE};
use crate::verbs::runtime::setting::model_arguments::CapArguments;
use crate::verbs::runtime::setting::worlds::WorldChoice;
use crate::{shipped, sources};
use clap::{Args, ValueHint};
use fab_agent::outcome::Outcome;
use fab_agent::record::{Header, Record, Report, RunCosts};
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct ResumeArguments {
    /// The run folder.
    #[arg(value_name = "RUN", value_hint = ValueHint::DirPath)]
    pub run: PathBuf,
    /// Other caps than those of the run.
    #[command(flatten)]
    pub caps: CapArguments,
    #[command(flatten)]
    pub events: EventArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

pub fn run(arguments: &ResumeArguments, io: &Io) -> Result<Exit, Failure> {
    let folder = fs::canonicalize(&arguments.run).map_err(|error| {
        Failure::environment(format!(
            "there is no run folder `{}`: {error}",
            arguments.run.display()
        ))
    })?;
    let Begun {
        directory,
        arguments: mut wanted,
    } = begun(&folder, &arguments.run)?;
    if let Some(exit) = ended(&folder, arguments, io) {
        return Ok(exit);
    }
    if wanted.world == WorldChoice::Arm {
        return Err(Failure::environment(format!(
            "the rollout in `{}` was carried out by an arm, which cannot do it again: see how it was left with `fabc robot recover --robot FILE`, and begin a new run",
            arguments.run.display()
        )));
    }
    wanted.json = arguments.json;
    // As the user names it, from this folder.
    wanted.events = arguments.events.absolute()?;
    wanted.spend.caps = arguments.caps.or(wanted.spend.caps);
    // Paths on the command line are relative to the folder where it was run.
    std::env::set_current_dir(&directory).map_err(|error| {
        Failure::environment(format!(
            "the folder `{}` cannot be entered: {error}; the run was begun there",
            directory.display()
        ))
    })?;
    shipped::restore(&wanted.task.file, io)?;
    run::play(&wanted, Some(&folder), io)
}

/// Reads how the run was started.
fn begun(folder: &Path, named: &Path) -> Result<Begun, Failure> {
    let path: PathBuf = folder.join(RUN_FILE);
    let wrong = |why: String| {
        Failure::environment(format!(
            "`{}` cannot be resumed: {why}; `fabc bench SUITE --out DIR` resumes the rollouts of a suite",
            named.display()
        ))
    };
    let text = sources::read_text(&path);
    let text = text.map_err(|why| wrong(format!("its {RUN_FILE} cannot be read ({why})")))?;
    let begun = serde_json::from_str(&text);
    begun.map_err(|error| wrong(format!("its {RUN_FILE} is damaged ({error})")))
}

/// A rollout that had ended, as [`fab_agent::rollout::Ended`] prints it; its costs may be lost.
#[derive(Serialize)]
struct EndedBefore {
    #[serde(flatten)]
    header: Header,
    #[serde(flatten)]
    report: Report,
    #[serde(flatten)]
    took: Option<RunCosts>,
}

/// Reports a rollout that ended for good; one ended by the user, a cap or an unavailable model did not. The exit code is
/// the run's.
fn ended(folder: &Path, arguments: &ResumeArguments, io: &Io) -> Option<Exit> {
    let record = Record::read(folder).ok()?;
    let report = record.end?.report;
    if let Outcome::Interrupted
    | Outcome::BudgetExhausted
    | Outcome::ModelFailed
    | Outcome::PolicyFailed = report.outcome
    {
        return None;
    }
    io.talk(&format!(
        "the rollout in `{}` has already ended ({}); there is nothing to resume",
        arguments.run.display(),
        report.outcome.name()
    ));
    let judged = report.operator.as_ref().map(|judgement| judgement.reached);
    let exit = run::exit_of(report.outcome, report.goal_reached, judged);
    if arguments.json {
        io.json(&EndedBefore {
            header: record.header,
            report,
            took: record.took,
        });
    }
    Some(exit)
}
