//! `--watch`: runs a verb again whenever a file that it used has changed.
//!
//! In: the files of a command line, and the verb. Out: the verb's own output, again and again. Events of the system
//! only wake it; whether anything changed is read from the files themselves, so that any way in which an editor
//! replaces a file is the same here, and no event is kept.

pub mod inputs;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use fab_base::interrupt::Interrupt;
use notify::{RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant, SystemTime};

/// How long nothing may happen before a change counts as whole: an editor writes, renames and deletes within this.
const QUIET: Duration = Duration::from_millis(120);
/// How long a folder in which something always happens can put that off.
const LONGEST_UNREST: Duration = Duration::from_secs(2);
/// How often files are looked at without any event, since not every file system tells of changes.
const UNASKED: Duration = Duration::from_secs(2);
/// How often an interrupt is looked for.
const INTERRUPTIBLE: Duration = Duration::from_millis(100);

/// Runs a verb, then again after each change, until Ctrl-C.
///
/// - `entries`: the `.fab` files; what they use is watched too.
/// - `others`: further files that the command line names.
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
        // Taken before the verb reads them, so that a change while it runs counts.
        let seen = stamps(&files);
        io.clear();
        if let Err(failure) = verb() {
            io.talk(&format!("error: {failure}"));
        }
        say_watching(&seen, io);
        wait_for_change(&files, seen, &mut folders, &interrupt, io)?;
        if interrupt.is_raised() {
            return Ok(Exit::Interrupted);
        }
    }
}

/// What tells one content of a file from another; none: there is no file.
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

/// Returns once a file has changed and all that there were are there, or on an interrupt.
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
        // A file that came back is worth a run even if it is as it was, since its loss was told.
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

/// The folders in which something may happen. Files themselves are not watched: a new file of the same name would not be.
struct Folders {
    watcher: RecommendedWatcher,
    watched: BTreeSet<PathBuf>,
    woken: Receiver<()>,
}

impl Folders {
    fn new() -> Result<Folders, Failure> {
        // One message is enough to wake; what does not fit is dropped.
        let (wake, woken) = sync_channel(1);
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            // Reading the files is an event too, and would wake without end.
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

    /// Watches the folders of these files, or the nearest above them that there are, and no others.
    fn watch(&mut self, files: &BTreeSet<PathBuf>) -> Result<(), Failure> {
        let links = files.iter().filter_map(|path| path.canonicalize().ok());
        let places = links.chain(files.iter().cloned());
        let wanted: BTreeSet<PathBuf> = places.filter_map(|path| folder_of(&path)).collect();
        for folder in self.watched.difference(&wanted) {
            // One that was deleted is not watched any more.
            let _ = self.watcher.unwatch(folder);
        }
        let mut watched = BTreeSet::new();
        for folder in wanted {
            if !self.watched.contains(&folder) {
                match self.watcher.watch(&folder, RecursiveMode::NonRecursive) {
                    Ok(()) => {}
                    // It was there a moment ago; the next look finds the one above it.
                    Err(_) if !folder.is_dir() => continue,
                    Err(error) => return Err(unwatchable(error)),
                }
            }
            watched.insert(folder);
        }
        self.watched = watched;
        Ok(())
    }

    /// Sleeps until something has happened and is over, or until it is time to look unasked.
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

/// Returns the nearest folder above a file that there is, as an absolute path.
fn folder_of(path: &Path) -> Option<PathBuf> {
    let path = std::path::absolute(path).ok()?;
    let folder = path.ancestors().skip(1).find(|folder| folder.is_dir())?;
    Some(folder.to_owned())
}
