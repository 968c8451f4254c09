//! `--watch`: runs a verb again whenever a file that it used has changed.
//!
//! In: the files of a command line, and the verb. Out: the verb's output after each run. System events only trigger a
//! look; whether anything changed is read from the files themselves. So it does not matter how an editor replaces a
//! file, and no event has to be stored.

mod inputs;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use fab_base::interrupt::Interrupt;
use notify::{RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant, SystemTime};

/// How long to wait without events before a change counts as complete: an editor writes, renames and deletes within
/// this time.
const QUIET: Duration = Duration::from_millis(120);
/// The longest that constant activity in a folder can delay a run.
const LONGEST_UNREST: Duration = Duration::from_secs(2);
/// Interval at which files are checked without any event, since not every file system reports changes.
const UNASKED: Duration = Duration::from_secs(2);
/// Interval at which interrupts are checked.
const INTERRUPTIBLE: Duration = Duration::from_millis(100);

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
    let mut folders = Folders::new()?;
    loop {
        let files = inputs::files(entries, others);
        folders.watch(&files)?;
        // Taken before the verb reads the files, so that a change during its run counts.
        let seen = stamps(&files);
        io.clear();
        let ended = verb();
        if interrupt.is_raised() {
            return Ok(Exit::Interrupted);
        }
        if let Err(failure) = ended {
            io.talk(&format!("error: {failure}"));
        }
        say_watching(&seen, io);
        wait_for_change(&files, seen, &mut folders, &interrupt, io)?;
        if interrupt.is_raised() {
            return Ok(Exit::Interrupted);
        }
    }
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

/// Waits until a file has changed and all earlier files exist again, or until an interrupt.
fn wait_for_change(
    files: &BTreeSet<PathBuf>,
    seen: Stamps,
    folders: &mut Folders,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<(), Failure> {
    let mut reported = BTreeSet::new();
    while !interrupt.is_raised() {
        folders.watch(files)?;
        let now = stamps(files);
        let gone = |path: &&PathBuf| seen[*path].is_some() && now[*path].is_none();
        let gone: BTreeSet<PathBuf> = files.iter().filter(gone).cloned().collect();
        for path in gone.difference(&reported) {
            let shown = path.display();
            io.talk(&format!("`{shown}` is gone; waiting until it is back"));
        }
        // A file that returns triggers a run even if unchanged, since its loss was reported.
        let is_back = gone.is_empty() && !reported.is_empty();
        if gone.is_empty() && (is_back || now != seen) {
            return Ok(());
        }
        reported.extend(gone);
        folders.sleep(interrupt);
    }
    Ok(())
}

fn say_watching(seen: &Stamps, io: &Io) {
    let present = seen.values().flatten().count();
    let files = if present == 1 { "file" } else { "files" };
    io.talk(&format!("watching {present} {files}; Ctrl-C ends"));
}

/// The folders to watch. Watching the files themselves would miss a new file of the same name.
struct Folders {
    watcher: RecommendedWatcher,
    watched: BTreeSet<PathBuf>,
    woken: Receiver<()>,
}

impl Folders {
    fn new() -> Result<Folders, Failure> {
        // One message is enough to wake the thread; further ones are dropped.
        let (wake, woken) = sync_channel(1);
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            // Reading the files raises access events, which would wake this without end.
            if event.is_ok_and(|event| event.kind.is_access()) {
                return;
            }
            let _ = wake.try_send(());
        });
        Ok(Folders {
            watcher: watcher.map_err(unwatchable)?,
            watched: BTreeSet::new(),
            woken,
        })
    }

    /// Watches exactly the folders of these files; for a missing folder, its nearest existing parent.
    fn watch(&mut self, files: &BTreeSet<PathBuf>) -> Result<(), Failure> {
        let links = files.iter().filter_map(|path| path.canonicalize().ok());
        let places = links.chain(files.iter().cloned());
        let wanted: BTreeSet<PathBuf> = places.filter_map(|path| folder_of(&path)).collect();
        for folder in self.watched.difference(&wanted) {
            // A deleted folder is no longer watched.
            let _ = self.watcher.unwatch(folder);
        }
        let mut watched = BTreeSet::new();
        for folder in wanted {
            if !self.watched.contains(&folder) {
                match self.watcher.watch(&folder, RecursiveMode::NonRecursive) {
                    Ok(()) => {}
                    // It existed a moment ago; the next look finds its parent.
                    Err(_) if !folder.is_dir() => continue,
                    Err(error) => return Err(unwatchable(error)),
                }
            }
            watched.insert(folder);
        }
        self.watched = watched;
        Ok(())
    }

    /// Sleeps until a change has happened and is complete, or until the next check without events.
    fn sleep(&self, interrupt: &Interrupt) {
        let begun = Instant::now();
        while self.woken.recv_timeout(INTERRUPTIBLE).is_err() {
            if begun.elapsed() > UNASKED || interrupt.is_raised() {
                return;
            }
        }
        let begun = Instant::now();
        while begun.elapsed() < LONGEST_UNREST && self.woken.recv_timeout(QUIET).is_ok() {}
    }
}

fn unwatchable(error: notify::Error) -> Failure {
    Failure::environment(format!("files cannot be watched: {error}"))
}

/// Returns the nearest existing folder above a file, as an absolute path.
fn folder_of(path: &Path) -> Option<PathBuf> {
    let path = std::path::absolute(path).ok()?;
    let folder = path.ancestors().skip(1).find(|folder| folder.is_dir())?;
    Some(folder.to_owned())
}
