//! Changes that happen whole or not at all: new files aside, one journal that decides, then steps that may be repeated.
//!
//! In: new files and steps. Out: a folder in which all steps are done, or none; whoever comes next after a stop finds
//! `.change/journal.json` and does the steps again, or finds none and removes what was put aside. A change is made under a lock.
//! Which steps make up a change is left to `change.rs`.

use super::disk::Disk;
use super::name::Name;
use super::{SnapshotError, format};
use serde::{Deserialize, Serialize};
use std::fs::{self, File, TryLockError};
use std::io::{self, Read};
use std::path::Path;
use std::time::Duration;

/// The folder in a snapshot folder that holds a change until it is done.
pub const CHANGE: &str = ".change";
/// The file in it whose presence decides that the change happens.
const JOURNAL: &str = "journal.json";
/// Where that file is written before it gets its name.
const JOURNAL_PART: &str = "journal.part";
/// The longest journal that is read, bytes.
const MAX_JOURNAL_BYTES: u64 = 64 << 20;
/// How often a lock is tried, and how long is waited in between: a change takes milliseconds, so two seconds in all.
const LOCK_TRIES: u32 = 100;
const LOCK_WAIT: Duration = Duration::from_millis(20);

/// One step of a change; each may be done again after it was done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// A file that lies aside, by its number, takes a name.
    Place { aside: u32, file: String },
    /// A file takes another's name.
    Move { from: String, to: String },
    /// A file goes.
    Remove { file: String },
}

/// Holds a folder for this process until it is dropped.
#[derive(Debug)]
pub struct Lock {
    _folder: File,
}

impl Lock {
    /// Takes the lock of a folder that exists; waits for another process a while.
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

/// The folder itself can be locked, so that no file of ours stays beside the snapshots.
#[cfg(unix)]
fn handle(folder: &Path) -> io::Result<File> {
    File::open(folder)
}

/// Folders cannot be opened here; a hidden file stays.
#[cfg(not(unix))]
fn handle(folder: &Path) -> io::Result<File> {
    let mut options = File::options();
    options
        .write(true)
        .create(true)
        .truncate(false)
        .open(folder.join(".lock"))
}

/// Returns whether a change was begun and not ended.
pub fn is_interrupted(folder: &Path) -> bool {
    fs::symlink_metadata(folder.join(CHANGE)).is_ok()
}

/// Does the steps, all or none, with the new files that they place.
///
/// An error before the journal has its name leaves the folder as it was; after that, the next that
/// calls [`recover`] does the rest.
pub fn commit(
    disk: &dyn Disk,
    folder: &Path,
    new_files: &[Vec<u8>],
    steps: &[Step],
) -> Result<(), SnapshotError> {
    let aside = folder.join(CHANGE);
    let unwritable = |error: io::Error| SnapshotError::unwritable(folder, &error);
    if let Err(error) = put_aside(disk, folder, new_files, steps) {
        // What is left of it does not count; its removal may fail for the same reason.
        let _ = disk.remove_folder(&aside);
        return Err(unwritable(error));
    }
    finish(disk, folder, steps).map_err(unwritable)
}

/// Ends a change that was interrupted: does it where it was decided, and forgets it where not.
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
    // What takes the place of an accepted file must outlast a loss of power. What is new can be proposed again, and
    // waiting for each of a thousand takes longer than making them.
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

/// A source that is not there was moved before the change was interrupted.
fn moved(disk: &dyn Disk, from: &Path, to: &Path) -> io::Result<()> {
    gone(disk.rename(from, to))
}

fn gone(done: io::Result<()>) -> io::Result<()> {
    match done {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        done => done,
    }
}

/// Returns a file that a step names and that no step of ours could.
///
/// A journal may come with a checkout of somebody else's, and must not reach other files.
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
