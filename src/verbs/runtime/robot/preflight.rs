//! Checks before a real arm is moved: no other fabc uses it, and its last run left nothing to recover.
//!
//! In: the arm's settings file and the record of its last run beside it. Out: nothing, or what prevents motion and what to
//! do about it. A simulated arm ends with its program, so it needs no checks.

use fab_arm::journal::{self, JournalError, RunState};
use std::fs::{File, TryLockError};
use std::path::Path;

/// Locks the arm until this process ends; fails if another fabc uses it.
pub fn claim(robot: &Path) -> Result<(), String> {
    let name = robot.display();
    let file = File::open(robot).map_err(|error| format!("`{name}`: {error}"))?;
    if let Err(TryLockError::WouldBlock) = file.try_lock() {
        return Err(format!(
            "another fabc uses the arm of `{name}`: wait until it has ended"
        ));
    }
    // The system unlocks it. Not every file system has locks; without them the user must take care.
    std::mem::forget(file);
    Ok(())
}

/// Fails if the arm needs recovery after its last run.
pub fn check(robot: &Path) -> Result<(), String> {
    to_recover(robot).map_or(Ok(()), |left| {
        Err(format!(
            "nothing is moved, because of how the last run with the arm of `{}` ended: {left}",
            robot.display()
        ))
    })
}

/// Returns how the last run left the arm and what to do about it; `None` if there is nothing to do.
pub fn to_recover(robot: &Path) -> Option<String> {
    let left = journal::left(robot);
    if left.as_ref().is_ok_and(RunState::is_clear) {
        return None;
    }
    Some(format!(
        "{}; see to the arm, and say so with `fabc robot recover --robot {}`",
        told(&left),
        robot.display()
    ))
}

/// Says how a run left the arm.
pub fn told(left: &Result<RunState, JournalError>) -> String {
    match left {
        Ok(state) => state.to_string(),
        Err(error) => format!("its state is unknown: {error}"),
    }
}
