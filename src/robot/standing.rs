//! Whether this program may move a real arm: no other one does, and the last run did not leave it in the middle.
//!
//! In: the arm's settings file and the note beside it. Out: nothing, or what stands against it and what to do. An arm that
//! this program simulates ends with it, so that nothing is asked of one.

use super::recover::in_words;
use crate::output;
use fab_arm::last;
use fab_arm::last::Standing;
use fab_arm::log::{Left, left};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The settings files that this process has locked; they are let go at its end, however it ends.
static CLAIMED: Mutex<Vec<(PathBuf, File)>> = Mutex::new(Vec::new());

/// Keeps every other fabc from this arm until this process ends; says why it cannot.
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
        // Not every file system has locks; without them the user takes care.
        Ok(()) | Err(TryLockError::Error(_)) => {
            claimed.push((path, file));
            Ok(())
        }
    }
}

/// Says how a run left the arm, where it is in the middle of a motion or its hand may hold something.
pub fn say_left(run: &Path) {
    match left(run) {
        Ok(Left::Clear) => {}
        Ok(left) => output::talk(&format!(
            "note: this is how the arm was left: {}; see to it, and say so with `fabc robot recover {}`",
            in_words(&left),
            run.display()
        )),
        Err(error) => output::talk(&format!(
            "note: in what state the arm was left is not known: {error}"
        )),
    }
}

/// Fails where the last run left the arm in the middle of a motion, or with something in its hand.
pub fn check(robot: &Path) -> Result<(), String> {
    let file = robot.display();
    match last::standing(robot).map_err(|error| error.to_string())? {
        Standing::Clear => Ok(()),
        Standing::Unclear { run, left } => {
            let (run, left) = (run.display(), in_words(&left));
            Err(format!(
                "nothing is moved: the last run with the arm of `{file}` left it in the middle: {left}; see to the arm, and say \
                 so with `fabc robot recover {run}`"
            ))
        }
        Standing::Unknown { why, .. } => Err(format!(
            "nothing is moved: in what state the last run left the arm of `{file}` is not known: {why}; see to the arm, and \
             say so with `fabc robot recover --robot {file}`"
        )),
    }
}
