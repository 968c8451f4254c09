//! What a folder of snapshots should hold, what it holds, and the change between them.

use super::SnapArguments;
use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{Contents, FOLDER, Folder, Info, Name, Side, Snapshot, SnapshotError};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The snapshots beside some tasks.
pub struct Plan {
    /// The folder that holds the tasks.
    tasks: PathBuf,
    pub folder: Folder,
    /// The accepted snapshots; `None` for one that cannot be read.
    accepted: BTreeMap<Name, Option<Snapshot>>,
    /// The pending snapshots that can be read; others are proposed again.
    pending: BTreeMap<Name, Snapshot>,
    expected: BTreeMap<Name, Expected>,
    /// The processed files, as snapshots name them.
    sources: BTreeSet<String>,
}

/// A snapshot that should exist.
pub struct Expected {
    /// What it is of.
    pub info: Info,
    /// How the accepted one differs.
    pub state: State,
    /// What it should hold; `None` if this build cannot tell, or if none of its inputs has changed.
    pub taken: Option<Snapshot>,
}

/// The state of one snapshot.
pub struct SnapshotState {
    /// Its name.
    pub name: Name,
    /// The accepted file, whether or not it exists.
    pub path: PathBuf,
    /// What it is of.
    pub info: Info,
    /// How the accepted snapshot differs.
    pub state: State,
    /// Whether a pending snapshot exists or is written now.
    pub is_pending: bool,
}

/// How an accepted snapshot differs from what it should hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It does not.
    Same,
    /// This build cannot tell.
    Unchecked,
    /// Its contents differ, or it cannot be read.
    Changed,
    /// It does not exist.
    New,
    /// It exists, but nothing declares it any more.
    Orphaned,
}

impl State {
    /// Returns the word that scripts rely on.
    pub fn word(self) -> &'static str {
        match self {
            State::Same => "same",
            State::Unchecked => "unseen",
            State::Changed => "changed",
            State::New => "new",
            State::Orphaned => "orphaned",
        }
    }
}

impl SnapshotState {
    /// Returns whether it needs no action.
    pub fn is_clean(&self) -> bool {
        matches!(self.state, State::Same | State::Unchecked) && !self.is_pending
    }
}

impl Plan {
    /// Reads the snapshots of a folder of tasks, and reports those of `fabc` that cannot be read.
    pub fn open(tasks: &Path, io: &Io) -> Result<Plan, Failure> {
        let folder = Folder::open(tasks.join(FOLDER)).map_err(Failure::environment)?;
        let read = |name: &Name, side| folder.read(name, side);
        let accepted = folder.accepted.iter().map(|name| {
            let accepted = read(name, Side::Accepted).unwrap_or_else(|error| {
                if name.is_ours() {
                    io.talk(&format!("note: {error}; it counts as changed"));
                }
                None
            });
            (name.clone(), accepted)
        });
        let pending = folder.pending.iter().filter_map(|name| {
            let pending = read(name, Side::Pending).ok()??;
            Some((name.clone(), pending))
        });
        Ok(Plan {
            tasks: tasks.to_owned(),
            accepted: accepted.collect(),
            pending: pending.collect(),
            expected: BTreeMap::new(),
            sources: BTreeSet::new(),
            folder,
        })
    }

    /// Adds the snapshots of a file; fails if another file declares one of the same name.
    pub fn expect(&mut self, source: &str, expected: Vec<(Name, Expected)>) -> Result<(), Failure> {
        self.sources.insert(source.to_owned());
        for (name, expected) in expected {
            if self.expected.contains_key(&name) {
                return Err(Failure::usage(format!(
                    "two files declare what `{name}` would be a snapshot of; rename a task, or keep the files in two folders"
                )));
            }
            self.expected.insert(name, expected);
        }
        Ok(())
    }

    /// Returns an accepted snapshot that can be read.
    pub fn accepted(&self, name: &Name) -> Option<&Snapshot> {
        self.accepted.get(name)?.as_ref()
    }

    /// Returns a pending snapshot that can be read.
    pub fn pending(&self, name: &Name) -> Option<&Snapshot> {
        self.pending.get(name)
    }

    /// Compares the accepted snapshot with what it should hold.
    pub fn compared(&self, name: &Name, contents: &Contents) -> State {
        match self.accepted.get(name) {
            Some(Some(accepted)) if accepted.contents.is_same(contents) => State::Same,
            Some(_) => State::Changed,
            None => State::New,
        }
    }

    /// Returns the states of the expected snapshots, and of orphans.
    pub fn states(&self) -> Vec<SnapshotState> {
        let state = |name: &Name, info: &Info, state| SnapshotState {
            path: self.folder.file(name, Side::Accepted),
            name: name.clone(),
            info: info.clone(),
            state,
            is_pending: self.folder.pending.contains(name),
        };
        let expected = self.expected.iter();
        let expected = expected.map(|(name, it)| state(name, &it.info, it.state));
        let accepted = self.accepted.iter();
        let accepted = accepted.filter_map(|(name, it)| Some((name, it.as_ref()?)));
        let orphans = self.undeclared(accepted).filter(|(_, source, _)| {
            self.sources.contains(*source) || !self.tasks.join(source).exists()
        });
        let orphans = orphans.map(|(name, _, info)| state(name, info, State::Orphaned));
        expected.chain(orphans).collect()
    }

    /// Returns the snapshots of `fabc` that are not expected, with their sources. Those of other tools, such as of a test
    /// suite, have no source or details.
    fn undeclared<'s>(
        &self,
        snapshots: impl Iterator<Item = (&'s Name, &'s Snapshot)>,
    ) -> impl Iterator<Item = (&'s Name, &'s str, &'s Info)> {
        let undeclared = snapshots.filter(|(name, _)| !self.expected.contains_key(*name));
        undeclared.filter_map(|(name, snapshot)| {
            let metadata = &snapshot.metadata;
            Some((name, metadata.source.as_deref()?, metadata.info.as_ref()?))
        })
    }

    /// Writes differences as pending, removes pending snapshots that are not needed, and orphans if asked to.
    ///
    /// Updates in `states` which are pending.
    pub fn write(
        &self,
        states: &mut [SnapshotState],
        arguments: &SnapArguments,
    ) -> Result<(), Failure> {
        let write = || -> Result<(), SnapshotError> {
            for found in states {
                let name = &found.name;
                let taken = self.expected.get(name).map(|it| it.taken.as_ref());
                match (found.state, taken) {
                    (State::Changed | State::New, Some(Some(taken))) => {
                        if self.pending(name) != Some(taken) {
                            self.folder.propose(name, taken)?;
                        }
                        found.is_pending = true;
                    }
                    (State::Same, _) if found.is_pending => {
                        self.folder.remove(name, Side::Pending)?;
                        found.is_pending = false;
                    }
                    (State::Orphaned, _) if arguments.prune => {
                        self.folder.remove(name, Side::Accepted)?;
                    }
                    _ => {}
                }
            }
            // What was never accepted, and is no longer declared.
            for (name, source, _) in self.undeclared(self.pending.iter()) {
                if self.sources.contains(source) && !self.accepted.contains_key(name) {
                    self.folder.remove(name, Side::Pending)?;
                }
            }
            Ok(())
        };
        write().map_err(Failure::environment)
    }
}
