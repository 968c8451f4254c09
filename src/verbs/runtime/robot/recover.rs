//! `fabc robot recover`: reports how a run left an arm, and records that a person has recovered it.
//!
//! In: the run's journal of the arm, or the arm's settings with its last run recorded beside them; a description of what was
//! done. Out: a line in that journal, or if it is gone, in the record beside the settings. The arm is neither read nor moved.

use super::terminal::line_of;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::{Args, ValueHint};
use fab_arm::last_run::{self, Recovery};
use fab_arm::log::{ARM_FILE, ArmLog, Entry, RunState, run_state};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

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

pub(super) const NO_ANSWER: &str = "nobody said what was done";

pub fn run(arguments: &RecoverArguments, io: &Io) -> Result<Exit, Failure> {
    match (&arguments.run, &arguments.robot) {
        (Some(run), _) => of_run(run, arguments, io),
        (None, Some(robot)) => of_arm(robot, arguments, io),
        (None, None) => Err(Failure::usage(
            "name the run folder, or the arm's settings with `--robot FILE`",
        )),
    }
}

fn of_run(folder: &Path, arguments: &RecoverArguments, io: &Io) -> Result<Exit, Failure> {
    let shown = folder.display();
    if !folder.is_dir() {
        let why = format!("there is no run folder `{shown}`");
        return Err(Failure::environment(why));
    }
    if !folder.join(ARM_FILE).is_file() {
        return Err(Failure::environment(format!(
            "`{shown}` has no arm journal (`{ARM_FILE}`), so the state of the arm after it is unknown: name the folder of \
             a run with `--world arm`, or the arm's settings with `--robot FILE`"
        )));
    }
    let state = run_state(folder)?;
    if state == RunState::Clear {
        return Ok(say(json!(state), None, arguments, io));
    }
    let how = ask_what_was_done(&describe(&state), arguments, io)?;
    ArmLog::open(folder)?.write(&Entry::Recovered { how: how.clone() })?;
    Ok(say(json!(state), Some(how), arguments, io))
}

/// Recovers an arm after its last run; if that run's journal is gone, the recovery is recorded beside the settings.
fn of_arm(robot: &Path, arguments: &RecoverArguments, io: &Io) -> Result<Exit, Failure> {
    if !robot.is_file() {
        let why = format!("there are no settings `{}`", robot.display());
        return Err(Failure::environment(why));
    }
    let why = match last_run::recovery(robot)? {
        Recovery::NotNeeded => return Ok(say(json!(RunState::Clear), None, arguments, io)),
        Recovery::Needed { run, .. } => {
            io.talk(&format!("the last run is `{}`", run.display()));
            return of_run(&run, arguments, io);
        }
        Recovery::Unknown { why, .. } => why,
    };
    let state = format!("the state that the last run left the arm in is unknown: {why}");
    let how = ask_what_was_done(&state, arguments, io)?;
    last_run::record_recovery(robot, &how)?;
    let state = json!({ "left": "unknown", "why": why });
    Ok(say(state, Some(how), arguments, io))
}

/// Reports how the arm was left, and what a person did about it.
fn say(mut document: Value, how: Option<String>, arguments: &RecoverArguments, io: &Io) -> Exit {
    document["recovered"] = json!(how);
    io.either(arguments.json, &document, || match how {
        None => "clear: no motion is open, and the hand holds nothing".to_owned(),
        Some(how) => format!("noted: {how}"),
    });
    Exit::Done
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
    let text = given.cloned().unwrap_or_else(|| {
        io.talk(question);
        // At the end of input the answer is empty.
        io.read(line_of).unwrap_or_default()
    });
    text.trim().to_owned()
}

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
    let segment = segment.name();
    let progress = if *is_verified {
        "was verified and is the last there is"
    } else {
        "was begun and not verified"
    };
    let to = to_m.map_or(String::new(), |[x, y, z]| {
        format!("; the tool was to go to {x:.3}, {y:.3}, {z:.3} m")
    });
    let holds = if *may_hold {
        "may hold cloth"
    } else {
        "holds nothing"
    };
    let halted: String = why.iter().map(|why| format!("; halted: {why}")).collect();
    format!("`{segment}` of action {action} {progress}{to}; the hand {holds}{halted}")
}
