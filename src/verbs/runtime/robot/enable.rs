//! `fabc robot enable`: enables a stopped arm at a person's request.
//!
//! In: the arm's settings, and a reason. Out: an arm that accepts motion, verified by re-sending its current pose, and a line
//! in the last run's journal. What the hand holds, and what that run left unfinished, is unchanged.

use super::recover::{NO_ANSWER, describe, given_or_typed};
use super::{connect, preflight};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::{Args, ValueHint};
use fab_arm::driver::Arm;
use fab_arm::guard::Guard;
use fab_arm::last_run::{self, Recovery};
use fab_arm::log::{ARM_FILE, ArmLog, Entry};
use serde_json::json;
use std::path::{Path, PathBuf};

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
    let document = json!({ "enabled": true, "how": how });
    io.either(arguments.json, &document, || {
        "enabled: the arm accepts motion again".to_owned()
    });
    Ok(Exit::Done)
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
    let how = how.to_owned();
    let written = ArmLog::open(&run).and_then(|mut log| log.write(&Entry::Enabled { how }));
    written.map_err(|error| {
        Failure::environment(format!(
            "the arm is let go, and that could not be noted: {error}"
        ))
    })
}

/// Describes what the last run left unfinished: enabling the arm does not recover it.
fn unfinished_note(robot: &Path) -> Option<String> {
    Some(match last_run::recovery(robot) {
        Ok(Recovery::NotNeeded) => return None,
        Ok(Recovery::Needed { state, .. }) => {
            format!("the last run left it so: {}", describe(&state))
        }
        Ok(Recovery::Unknown { why, .. }) => {
            format!("in what state the last run left it is not known: {why}")
        }
        Err(error) => error.to_string(),
    })
}

#[cfg(test)]
mod tests;
