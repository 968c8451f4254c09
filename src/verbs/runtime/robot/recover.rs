//! `fabc robot recover`: reports how a run left an arm, and records that a person has recovered it.
//!
//! In: the run's journal of the arm, or the arm's settings with its last run recorded beside them; a description of what was
//! done. Out: a line in that journal, or if it is gone, in the record beside the settings. The arm is neither read nor moved.

use super::terminal::line_of;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use clap::{Args, ValueHint};
use fab_arm::last_run::{self, Recovery};
use fab_arm::log::{ARM_FILE, ArmLog, Entry, RunState, run_state};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `robot recover`.
#[derive(Args)]
pub struct RecoverArguments {
    /// The run folder.
    #[arg(value_name = "RUN", value_hint = ValueHint::DirPath, required_unless_present = "robot")]
    pub run: Option<PathBuf>,
    /// Instead of the run folder: the arm's settings. Its last run is meant, even if that folder was deleted.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "run")]
    pub robot: Option<PathBuf>,
    /// What was done, in words; default: asked on the terminal.
    #[arg(long, value_name = "WORDS")]
    pub how: Option<String>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

const BY_HAND: &str = "nothing is moved by this command: bring the arm to rest by hand, and take the cloth out of its fingers; \
`home` of the vendor's driver opens the hand";

/// The error if no description was given.
pub(super) const NO_ANSWER: &str = "nobody said what was done";

/// Reports the state, asks what was done, and records it.
pub fn run(arguments: &RecoverArguments, io: &Io) -> Result<Exit, Failure> {
    match (&arguments.run, &arguments.robot) {
        (Some(run), _) => of_run(run, arguments, io),
        (None, Some(robot)) => of_arm(robot, arguments, io),
        (None, None) => Err(Failure::usage(
            "name the run folder, or the arm's settings with `--robot FILE`",
        )),
    }
}

/// What is known of the arm, and what a person did about it.
#[derive(Serialize)]
struct Recovered {
    #[serde(flatten)]
    state: LastState,
    recovered: Option<String>,
}

/// How the arm was left, as far as it is known.
#[derive(Serialize)]
#[serde(untagged)]
enum LastState {
    Known(RunState),
    Unknown { left: &'static str, why: String },
}

fn of_run(folder: &Path, arguments: &RecoverArguments, io: &Io) -> Result<Exit, Failure> {
    if !folder.is_dir() {
        return Err(Failure::environment(format!(
            "there is no run folder `{}`",
            folder.display()
        )));
    }
    if !folder.join(ARM_FILE).is_file() {
        return Err(Failure::environment(format!(
            "`{}` has no arm journal (`{ARM_FILE}`), so the state of the arm after it is unknown: name the folder of \
             a run with `--world arm`, or the arm's settings with `--robot FILE`",
            folder.display()
        )));
    }
    let state = run_state(folder)?;
    if state == RunState::Clear {
        return Ok(say(LastState::Known(state), None, arguments, io));
    }
    let how = ask_what_was_done(&describe(&state), arguments, io)?;
    let mut log = ArmLog::open(folder)?;
    let entry = Entry::Recovered { how: how.clone() };
    log.write(&entry)?;
    Ok(say(LastState::Known(state), Some(how), arguments, io))
}

/// Recovers an arm after its last run; if that run's journal is gone, the recovery is recorded beside the settings.
fn of_arm(robot: &Path, arguments: &RecoverArguments, io: &Io) -> Result<Exit, Failure> {
    if !robot.is_file() {
        return Err(Failure::environment(format!(
            "there are no settings `{}`",
            robot.display()
        )));
    }
    let why = match last_run::recovery(robot)? {
        Recovery::NotNeeded => {
            return Ok(say(LastState::Known(RunState::Clear), None, arguments, io));
        }
        Recovery::Needed { run, .. } => {
            io.talk(&format!("the last run is `{}`", run.display()));
            return of_run(&run, arguments, io);
        }
        Recovery::Unknown { why, .. } => why,
    };
    let state = format!("the state that the last run left the arm in is unknown: {why}");
    let how = ask_what_was_done(&state, arguments, io)?;
    last_run::record_recovery(robot, &how)?;
    let left = "unknown";
    Ok(say(
        LastState::Unknown { left, why },
        Some(how),
        arguments,
        io,
    ))
}

fn say(state: LastState, how: Option<String>, arguments: &RecoverArguments, io: &Io) -> Exit {
    let recovered = how;
    io.result(arguments.json, &Recovered { state, recovered });
    Exit::Done
}

impl Report for Recovered {
    fn text(&self) -> String {
        match &self.recovered {
            None => "clear: no motion is open, and the hand holds nothing".to_owned(),
            Some(how) => format!("noted: {how}"),
        }
    }
}

/// Shows the state, and returns the description of what was done; fails without one.
fn ask_what_was_done(
    state: &str,
    arguments: &RecoverArguments,
    io: &Io,
) -> Result<String, Failure> {
    io.talk(state);
    io.talk(&format!("note: {BY_HAND}"));
    let question = "what was done, in a few words (empty: change nothing):";
    let how = given_or_typed(arguments.how.as_ref(), question, io);
    if how.is_empty() {
        return Err(Failure::environment(format!(
            "{NO_ANSWER}, so that the arm counts as left in the middle: {state}"
        )));
    }
    Ok(how)
}

/// Returns the text that was given as an option, or is typed as an answer; may be empty.
pub(super) fn given_or_typed(given: Option<&String>, question: &str, io: &Io) -> String {
    match given {
        Some(text) => text.trim().to_owned(),
        None => {
            io.talk(question);
            // At the end of input the answer is empty.
            let typed = io.read(line_of).unwrap_or_default();
            typed.trim().to_owned()
        }
    }
}

/// Describes how a run left the arm.
pub(super) fn describe(state: &RunState) -> String {
    let RunState::NeedsRecovery {
        segment,
        action,
        to_m,
        may_hold,
        is_verified,
        why,
    } = state
    else {
        return "clear".to_owned();
    };
    let segment = segment.text();
    let progress = if *is_verified {
        "was verified and is the last there is"
    } else {
        "was begun and not verified"
    };
    let mut text = format!("`{segment}` of action {action} {progress}");
    if let Some([x, y, z]) = to_m {
        text += &format!("; the tool was to go to {x:.3}, {y:.3}, {z:.3} m");
    }
    text += if *may_hold {
        "; the hand may hold cloth"
    } else {
        "; the hand holds nothing"
    };
    if let Some(why) = why {
        text += &format!("; halted: {why}");
    }
    text
}
