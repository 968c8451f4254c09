//! `--watch`: runs a verb again whenever a file that it used has changed.
//!
//! In: the files of a command line, and the verb. Out: the verb's output after each run. A task reads a handful of
//! files, so they are looked at several times a second: this works on every file system, and however an editor replaces
//! a file.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources;
use fab_base::interrupt::Interrupt;
use fab_base::wording::counted;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::time::{Duration, SystemTime};
use std::{fs, thread};

/// Interval between two looks at the files. A change counts once two looks see the same: editors write in steps.
const INTERVAL: Duration = Duration::from_millis(120);

/// Runs a verb; if it `watches`, again after each change of `entries`, of the files that they use, or of `others`, until
/// Ctrl-C.
pub fn run(
    watches: bool,
    entries: &[String],
    others: &[PathBuf],
    verb: impl Fn() -> Result<Exit, Failure>,
    io: &Io,
) -> Result<Exit, Failure> {
    if !watches {
        return verb();
    }
    let interrupt = io.interrupt()?;
    while !interrupt.is_raised() {
        let mut files: BTreeSet<PathBuf> = others.iter().cloned().collect();
        files.extend(entries.iter().flat_map(|entry| sources::used_files(entry)));
        // Taken before the verb reads the files, so that a change during its run counts.
        let seen = stamps(&files);
        io.clear();
        let ended = verb();
        if interrupt.is_raised() {
            break;
        }
        if let Err(failure) = ended {
            io.talk(&format!("error: {failure}"));
        }
        let n_present = seen.values().flatten().count();
        let watched = counted(n_present, "file");
        io.talk(&format!("watching {watched}; Ctrl-C ends"));
        wait_for_change(&files, &seen, &interrupt);
    }
    Ok(Exit::Interrupted)
}

/// Distinguishes versions of a file; `None` if there is no file.
type Stamp = Option<(u64, SystemTime)>;
type Stamps = BTreeMap<PathBuf, Stamp>;

fn stamps(files: &BTreeSet<PathBuf>) -> Stamps {
    let stamp = |path: &PathBuf| {
        let found = fs::metadata(path).ok()?;
        Some((found.len(), found.modified().ok()?))
    };
    let stamped = files.iter().map(|path| (path.clone(), stamp(path)));
    stamped.collect()
}

/// Waits until a file has changed, or until an interrupt.
fn wait_for_change(files: &BTreeSet<PathBuf>, seen: &Stamps, interrupt: &Interrupt) {
    let mut before = seen.clone();
    while !interrupt.is_raised() {
        thread::sleep(INTERVAL);
        let now = stamps(files);
        if now == before && now != *seen {
            return;
        }
        before = now;
    }
}
