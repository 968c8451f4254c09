//! `fabc robot enable`: enables a stopped arm at a person's request.
//!
//! In: the arm's settings, and a reason. Out: an arm that accepts motion, verified by re-sending its current pose, and a line
//! in the last run's journal. What the hand holds, and what that run left unfinished, is unchanged.

use super::recover::{NO_ANSWER, describe, given_or_typed};
use super::{connect, preflight};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use clap::{Args, ValueHint};
use fab_arm::driver::Arm;
use fab_arm::guard::Guard;
use fab_arm::last_run::{self, Recovery};
use fab_arm::log::{ARM_FILE, ArmLog, Entry};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `robot enable`.
#[derive(Args)]
pub struct EnableArguments {
    /// The arm's settings.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub robot: PathBuf,
    /// Why the arm was stopped and may move again; default: asked on the terminal.
    #[arg(long, value_name = "WORDS")]
    pub how: Option<String>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

const QUESTION: &str = "Once enabled, it moves on any command: is its way free, and a physical stop in reach? \
Why it was stopped and may go, in a few words; nothing to leave it stopped:";

/// Asks for a reason, and enables the arm.
pub fn run(arguments: &EnableArguments, io: &Io) -> Result<Exit, Failure> {
    let robot = &arguments.robot;
    let nothing = "it ends with the program that moves it, and is never left stopped";
    let settings = connect::settings_of_real(robot, nothing)?;
    preflight::claim(robot).map_err(Failure::environment)?;
    if let Some(note) = unfinished_note(robot) {
        io.talk(&format!("note: {note}"));
    }
    let how = given_or_typed(arguments.how.as_ref(), QUESTION, io);
    if how.is_empty() {
        return Err(Failure::environment(format!(
            "{NO_ANSWER}, so that the arm is left as it is"
        )));
    }
    let guard = Guard::level(&settings);
    let mut arm = connect::arm(&settings, guard).map_err(Failure::environment)?;
    enable(arm.as_mut(), robot, &how)?;
    io.result(arguments.json, &Enabled { enabled: true, how });
    Ok(Exit::Done)
}

/// An arm that accepts motion again.
#[derive(Serialize)]
struct Enabled {
    enabled: bool,
    how: String,
}

impl Report for Enabled {
    fn text(&self) -> String {
        "enabled: the arm accepts motion again".to_owned()
    }
}

/// Enables an arm, and records it if its last run has a journal.
fn enable(arm: &mut dyn Arm, robot: &Path, how: &str) -> Result<(), Failure> {
    arm.enable().map_err(|error| {
        Failure::environment(format!(
            "the arm was asked to enable motion, but it could not be verified that it accepts motion: {error}"
        ))
    })?;
    let run = last_run::folder(robot).ok().flatten();
    let Some(run) = run.filter(|run| run.join(ARM_FILE).is_file()) else {
        return Ok(());
    };
    let entry = Entry::Enabled {
        how: how.to_owned(),
    };
    let written = ArmLog::open(&run).and_then(|mut log| log.write(&entry));
    written.map_err(|error| {
        Failure::environment(format!(
            "the arm is let go, and that could not be noted: {error}"
        ))
    })
}

/// Describes what the last run left unfinished: enabling the arm does not recover it.
fn unfinished_note(robot: &Path) -> Option<String> {
    match last_run::recovery(robot) {
        Ok(Recovery::NotNeeded) => None,
        Ok(Recovery::Needed { state, .. }) => {
            Some(format!("the last run left it so: {}", describe(&state)))
        }
        Ok(Recovery::Unknown { why, .. }) => Some(format!(
            "in what state the last run left it is not known: {why}"
        )),
        Err(error) => Some(error.to_string()),
    }
}

#[cfg(test)]
mod tests;
