//! `--watch`: runs a verb again whenever a file that it used has changed.
//!
//! In: the files of a command line, and the verb. Out: the verb's output after each run. A task reads a handful of
//! files, so they are looked at several times a second: this works on every file system, and however an editor replaces
//! a file.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources::{self, Disk};
use fab_base::interrupt::Interrupt;
use fab_base::wording::counted;
use fab_compiler::{Listed, LoadError, Loader, Wanted};
use fab_program::{PINS_FILE, Trial, pins_folder};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, SystemTime};

/// Interval between two looks at the files. A change counts once two looks see the same: an editor writes, renames and
/// deletes within this time.
const INTERVAL: Duration = Duration::from_millis(120);

/// Runs a verb, then again after each change, until Ctrl-C.
///
/// - `entries`: the `.fab` files; the files that they use are watched too.
/// - `others`: further files named on the command line.
pub fn run(
    entries: &[String],
    others: &[PathBuf],
    verb: impl Fn() -> Result<Exit, Failure>,
    io: &Io,
) -> Result<Exit, Failure> {
    let interrupt = io.interrupt()?;
    while !interrupt.is_raised() {
        let files = files(entries, others);
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
    files
        .iter()
        .map(|path| (path.clone(), stamp(path)))
        .collect()
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

/// Returns the files of a command line and all files that they use, including missing ones.
fn files(entries: &[String], others: &[PathBuf]) -> BTreeSet<PathBuf> {
    let mut files: BTreeSet<PathBuf> = others.iter().cloned().collect();
    for entry in entries {
        let loader = RecordingLoader {
            disk: Disk::beside(entry),
            folder: sources::folder_of(entry),
            asked: RefCell::default(),
        };
        // Its findings are the verb's to report.
        let _ = fab_compiler::compile(entry, &loader);
        files.extend(loader.asked.into_inner());
    }
    files
}

/// A loader that reads from disk and records the requested files.
struct RecordingLoader {
    disk: Disk,
    folder: PathBuf,
    asked: RefCell<BTreeSet<PathBuf>>,
}

impl Loader for RecordingLoader {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        self.asked.borrow_mut().insert(PathBuf::from(name));
        self.disk.load(name)
    }

    fn look(&self, path: &str, _wanted: Wanted) -> Listed {
        self.asked.borrow_mut().insert(self.folder.join(path));
        Listed::Unknown
    }

    /// `fabc subgoals` writes this description after the pictures.
    fn trial(&self, title: &str) -> Option<Trial> {
        let pins = Path::new(&pins_folder(title)).join(PINS_FILE);
        self.asked.borrow_mut().insert(self.folder.join(pins));
        None
    }
}
