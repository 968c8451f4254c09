//! Checks before a real arm is moved: no other fabc uses it, and its last run left nothing to recover.
//!
//! In: the arm's settings file and the record of its last run beside it. Out: nothing, or what prevents motion and what to
//! do about it. A simulated arm ends with its program, so it needs no checks.

use crate::io::Io;
use fab_arm::journal::{self, JournalError, RunState};
use fab_arm::settings::{DriverKind, Settings};
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

/// Reports how a run left the arm, unless it is clear.
pub fn report_run_state(run: &Path, robot: &Path, settings: &Settings, io: &Io) {
    let left = journal::run_state(run);
    if left.as_ref().is_ok_and(RunState::is_clear) {
        return;
    }
    let what_to_do = match settings.driver {
        DriverKind::Simulated => String::new(),
        _ => see_to_it(robot),
    };
    let left = told(&left);
    io.talk(&format!(
        "note: this is how the arm was left: {left}{what_to_do}"
    ));
}

/// Fails if the arm needs recovery after its last run.
pub fn check(robot: &Path) -> Result<(), String> {
    let left = journal::left(robot);
    if left.as_ref().is_ok_and(RunState::is_clear) {
        return Ok(());
    }
    Err(format!(
        "nothing is moved, because of how the last run with the arm of `{}` ended: {}{}",
        robot.display(),
        told(&left),
        see_to_it(robot)
    ))
}

/// Says how a run left the arm.
pub fn told(left: &Result<RunState, JournalError>) -> String {
    match left {
        Ok(state) => state.to_string(),
        Err(error) => format!("its state is unknown: {error}"),
    }
}

fn see_to_it(robot: &Path) -> String {
    let robot = robot.display();
    format!("; see to the arm, and say so with `fabc robot recover --robot {robot}`")
}
