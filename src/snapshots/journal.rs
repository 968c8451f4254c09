//! Atomic changes: new files are staged, one journal file commits the change, then repeatable steps carry it out.
//!
//! In: new files and steps. Out: a folder in which all steps are done, or none. After a crash, the next process that
//! finds `.change/journal.json` repeats the steps; without a journal it removes the staged files. A change is made
//! under a lock. `change.rs` decides which steps make up a change.

use super::disk::Disk;
use super::name::Name;
use super::{SnapshotError, format};
use serde::{Deserialize, Serialize};
use std::fs::{self, File, TryLockError};
use std::io::{self, Read};
use std::path::Path;
use std::time::Duration;

/// The folder inside a snapshot folder that holds a change until it is done.
pub const CHANGE: &str = ".change";
/// The file in it whose presence commits the change.
const JOURNAL: &str = "journal.json";
/// Where that file is written before it is renamed.
const JOURNAL_PART: &str = "journal.part";
/// The longest journal that is read, bytes.
const MAX_JOURNAL_BYTES: u64 = 64 << 20;
/// How often to try the lock, and how long to wait in between: two seconds in all, while a change takes milliseconds.
const LOCK_TRIES: u32 = 100;
const LOCK_WAIT: Duration = Duration::from_millis(20);

/// One step of a change; every step may be repeated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// Moves the staged file of this number to its name.
    Place { aside: u32, file: String },
    /// Renames a file.
    Move { from: String, to: String },
    /// Removes a file.
    Remove { file: String },
}

/// A lock on a folder, held by this process until it is dropped.
#[derive(Debug)]
pub struct Lock {
    _folder: File,
}

impl Lock {
    /// Locks an existing folder; waits a while for another process.
    pub fn take(folder: &Path) -> Result<Lock, SnapshotError> {
        let file = handle(folder).map_err(|error| SnapshotError::unwritable(folder, &error))?;
        for _ in 0..LOCK_TRIES {
            match file.try_lock() {
                Ok(()) => return Ok(Lock { _folder: file }),
                Err(TryLockError::WouldBlock) => std::thread::sleep(LOCK_WAIT),
                Err(TryLockError::Error(error)) => {
                    return Err(SnapshotError::unwritable(folder, &error));
                }
            }
        }
        Err(SnapshotError::InUse {
            path: folder.to_owned(),
        })
    }
}

/// Unix can lock the folder itself, so no lock file stays beside the snapshots.
#[cfg(unix)]
fn handle(folder: &Path) -> io::Result<File> {
    File::open(folder)
}

/// Folders cannot be opened here, so a hidden lock file stays.
#[cfg(not(unix))]
fn handle(folder: &Path) -> io::Result<File> {
    let mut options = File::options();
    options
        .write(true)
        .create(true)
        .truncate(false)
        .open(folder.join(".lock"))
}

/// Returns whether a change was begun and not finished.
pub fn is_interrupted(folder: &Path) -> bool {
    fs::symlink_metadata(folder.join(CHANGE)).is_ok()
}

/// Carries out all steps or none, with the new files that they place.
///
/// An error before the journal is renamed leaves the folder unchanged; after that, the next call of [`recover`]
/// completes the change.
pub fn commit(
    disk: &dyn Disk,
    folder: &Path,
    new_files: &[Vec<u8>],
    steps: &[Step],
) -> Result<(), SnapshotError> {
    let aside = folder.join(CHANGE);
    let unwritable = |error: io::Error| SnapshotError::unwritable(folder, &error);
    if let Err(error) = put_aside(disk, folder, new_files, steps) {
        // Leftovers are ignored later; their removal may fail for the same reason.
        let _ = disk.remove_folder(&aside);
        return Err(unwritable(error));
    }
    finish(disk, folder, steps).map_err(unwritable)
}

/// Finishes an interrupted change: completes it if its journal was written, otherwise discards it.
pub fn recover(disk: &dyn Disk, folder: &Path) -> Result<(), SnapshotError> {
    let aside = folder.join(CHANGE);
    let foreign = |path: &Path, why: String| SnapshotError::Foreign {
        path: path.to_owned(),
        why,
    };
    match fs::symlink_metadata(&aside) {
        Ok(found) if found.is_dir() => {}
        Ok(_) => return Err(foreign(&aside, "it is no folder".to_owned())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(SnapshotError::unreadable(&aside, &error)),
    }
    let path = aside.join(JOURNAL);
    let unwritable = |error: io::Error| SnapshotError::unwritable(folder, &error);
    match fs::symlink_metadata(&path) {
        Ok(found) if found.is_file() => {}
        Ok(_) => return Err(foreign(&path, "it is no file".to_owned())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return disk.remove_folder(&aside).map_err(unwritable);
        }
        Err(error) => return Err(SnapshotError::unreadable(&path, &error)),
    }
    let mut text = Vec::new();
    File::open(&path)
        .and_then(|file| file.take(MAX_JOURNAL_BYTES).read_to_end(&mut text))
        .map_err(|error| SnapshotError::unreadable(&path, &error))?;
    let steps: Vec<Step> =
        serde_json::from_slice(&text).map_err(|error| foreign(&path, error.to_string()))?;
    if let Some(file) = steps.iter().find_map(stray) {
        return Err(foreign(&path, format!("`{file}` is no snapshot's file")));
    }
    finish(disk, folder, &steps).map_err(unwritable)
}

fn put_aside(
    disk: &dyn Disk,
    folder: &Path,
    new_files: &[Vec<u8>],
    steps: &[Step],
) -> io::Result<()> {
    let aside = folder.join(CHANGE);
    disk.make_folder(&aside)?;
    for (number, bytes) in new_files.iter().enumerate() {
        disk.write(&aside.join(number.to_string()), bytes)?;
    }
    // A file that replaces an accepted one must survive a loss of power. New files can be proposed again, and syncing
    // each of a thousand takes longer than making them.
    for step in steps {
        if let Step::Move { from, to } = step
            && folder.join(to).exists()
        {
            disk.sync(&folder.join(from))?;
        }
    }
    let part = aside.join(JOURNAL_PART);
    disk.write(&part, &serde_json::to_vec(steps)?)?;
    disk.sync(&part)?;
    disk.sync(folder)?;
    disk.rename(&part, &aside.join(JOURNAL))
}

fn finish(disk: &dyn Disk, folder: &Path, steps: &[Step]) -> io::Result<()> {
    let aside = folder.join(CHANGE);
    disk.sync(&aside)?;
    for step in steps {
        match step {
            Step::Place {
                aside: number,
                file,
            } => moved(disk, &aside.join(number.to_string()), &folder.join(file))?,
            Step::Move { from, to } => moved(disk, &folder.join(from), &folder.join(to))?,
            Step::Remove { file } => gone(disk.remove(&folder.join(file)))?,
        }
    }
    disk.sync(folder)?;
    disk.remove(&aside.join(JOURNAL))?;
    disk.remove_folder(&aside)
}

/// If the source is missing, it was moved before the change was interrupted.
fn moved(disk: &dyn Disk, from: &Path, to: &Path) -> io::Result<()> {
    gone(disk.rename(from, to))
}

fn gone(done: io::Result<()>) -> io::Result<()> {
    match done {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        done => done,
    }
}

/// Returns a file name in a step that no step of ours could contain.
///
/// A journal may come with somebody else's checkout, and must not reach files outside the folder.
fn stray(step: &Step) -> Option<&str> {
    let files: &[&String] = match step {
        Step::Place { file, .. } | Step::Remove { file } => &[file],
        Step::Move { from, to } => &[from, to],
    };
    let is_ours = |file: &str| {
        let base = file
            .strip_suffix(format::PICTURE)
            .and_then(|base| base.strip_suffix('.'));
        Name::of_file(base.unwrap_or(file)).is_some()
    };
    files
        .iter()
        .map(|file| file.as_str())
        .find(|file| !is_ours(file))
}
