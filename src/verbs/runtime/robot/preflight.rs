//! Checks before a real arm is moved: no other fabc uses it, and its last run left nothing to recover.
//!
//! In: the arm's settings file and the record of its last run beside it. Out: nothing, or what prevents motion and what to
//! do about it. A simulated arm ends with its program, so it needs no checks.

use super::recover::describe;
use crate::io::Io;
use fab_arm::last_run::{self, Recovery};
use fab_arm::log::{RunState, run_state};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The settings files that this process has locked; the system unlocks them when it ends.
static CLAIMED: Mutex<Vec<(PathBuf, File)>> = Mutex::new(Vec::new());

/// Locks the arm for this process; fails if another fabc uses it.
pub fn claim(robot: &Path) -> Result<(), String> {
    let unreadable = |error: std::io::Error| format!("`{}`: {error}", robot.display());
    let path = std::fs::canonicalize(robot).map_err(unreadable)?;
    let mut claimed = CLAIMED.lock().unwrap_or_else(PoisonError::into_inner);
    if claimed.iter().any(|(other, _)| *other == path) {
        return Ok(());
    }
    let file = File::open(&path).map_err(unreadable)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(format!(
            "another fabc uses the arm of `{}`: wait until it has ended",
            robot.display()
        )),
        // Not every file system has locks; without them the user must take care.
        Ok(()) | Err(TryLockError::Error(_)) => {
            claimed.push((path, file));
            Ok(())
        }
    }
}

/// Reports how a run left the arm, if the arm needs recovery.
pub fn report_run_state(run: &Path, io: &Io) {
    let note = match run_state(run) {
        Ok(RunState::Clear) => return,
        Ok(state) => format!(
            "this is how the arm was left: {}; see to it, and say so with `fabc robot recover {}`",
            describe(&state),
            run.display()
        ),
        Err(error) => format!("in what state the arm was left is not known: {error}"),
    };
    io.talk(&format!("note: {note}"));
}

/// Fails if the arm needs recovery after its last run.
pub fn check(robot: &Path) -> Result<(), String> {
    let file = robot.display();
    match last_run::recovery(robot).map_err(|error| error.to_string())? {
        Recovery::NotNeeded => Ok(()),
        Recovery::Needed { run, state } => {
            let (run, state) = (run.display(), describe(&state));
            Err(format!(
                "nothing is moved: the last run with the arm of `{file}` left it in the middle: {state}; see to the arm, and say \
                 so with `fabc robot recover {run}`"
            ))
        }
        Recovery::Unknown { why, .. } => Err(format!(
            "nothing is moved: in what state the last run left the arm of `{file}` is not known: {why}; see to the arm, and \
             say so with `fabc robot recover --robot {file}`"
        )),
    }
}
