//! The intended contents of a snapshot folder, its actual contents, and the change between them.

use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{FOLDER, Folder, Info, Name, Operation, Snapshot};
use crate::verbs::snap::SnapArguments;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The intended contents of a snapshot folder.
pub struct Plan {
    /// The folder that holds the tasks.
    tasks: PathBuf,
    pub folder: Folder,
    expected: BTreeMap<Name, Intended>,
    /// The processed files, as snapshots name them.
    sources: BTreeSet<String>,
    /// Snapshots already reported as unreadable.
    reported: Mutex<BTreeSet<Name>>,
}

/// The intended contents of one snapshot.
pub enum Intended {
    /// These contents.
    Taken(Box<Snapshot>),
    /// Its accepted contents: none of its inputs has changed.
    AsAccepted(Info),
    /// It should exist; this build cannot compute its contents.
    Unchecked(Info),
    /// It exists, but its bytes differ from its recorded hash; this build cannot redraw it.
    Damaged(Info),
}

/// The result of reading an accepted snapshot.
pub enum Readable {
    /// It was read, or does not exist.
    Yes(Option<Box<Snapshot>>),
    /// It exists but cannot be read.
    No,
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

/// How an accepted snapshot differs from the intended one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It does not.
    Same,
    /// This build cannot tell.
    Unchecked,
    /// Its contents differ.
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
    /// Opens the snapshots of a folder of tasks.
    pub fn open(tasks: &Path) -> Result<Plan, Failure> {
        Ok(Plan {
            tasks: tasks.to_owned(),
            folder: Folder::open(tasks.join(FOLDER)).map_err(Failure::environment)?,
            expected: BTreeMap::new(),
            sources: BTreeSet::new(),
            reported: Mutex::default(),
        })
    }

    /// Records that a file was processed completely.
    pub fn looked_at(&mut self, source: &str) {
        self.sources.insert(source.to_owned());
    }

    /// Adds a snapshot; fails if another file declares one of the same name.
    pub fn add_expected(&mut self, name: Name, intended: Intended) -> Result<(), Failure> {
        let is_taken = self.expected.contains_key(&name);
        if is_taken {
            return Err(Failure::usage(format!(
                "two files declare what `{name}` would be a snapshot of; rename a task, or keep the files in two folders"
            )));
        }
        self.expected.insert(name, intended);
        Ok(())
    }

    /// Compares intended with accepted snapshots, and finds orphans.
    ///
    /// An unreadable accepted snapshot counts as changed, with a note: it is proposed again.
    pub fn states(&self, io: &Io) -> Vec<SnapshotState> {
        let pending: BTreeSet<&Name> = self.folder.pending_names().collect();
        let mut found = Vec::with_capacity(self.expected.len());
        for (name, intended) in &self.expected {
            let (info, state) = match intended {
                Intended::AsAccepted(info) => (info.clone(), State::Same),
                Intended::Unchecked(info) => (info.clone(), State::Unchecked),
                Intended::Damaged(info) => (info.clone(), State::Changed),
                Intended::Taken(taken) => {
                    let state = match self.accepted(name, io) {
                        Readable::No => State::Changed,
                        Readable::Yes(None) => State::New,
                        Readable::Yes(Some(accepted))
                            if accepted.contents.is_same(&taken.contents) =>
                        {
                            State::Same
                        }
                        Readable::Yes(Some(_)) => State::Changed,
                    };
                    (taken.metadata.info.clone().unwrap_or_default(), state)
                }
            };
            found.push(SnapshotState {
                path: self.folder.accepted_path(name),
                name: name.clone(),
                info,
                state,
                is_pending: pending.contains(name),
            });
        }
        for name in self.folder.accepted_names() {
            if self.expected.contains_key(name) {
                continue;
            }
            // An unreadable snapshot cannot be attributed to a file, so it is left alone.
            let accepted = self.folder.accepted(name).ok().flatten();
            let Some(metadata) = accepted.map(|accepted| accepted.metadata) else {
                continue;
            };
            // Ignore snapshots of others, such as those of a test suite.
            let Some((source, info)) = metadata.source.zip(metadata.info) else {
                continue;
            };
            if self.sources.contains(&source) || !self.tasks.join(&source).exists() {
                found.push(SnapshotState {
                    path: self.folder.accepted_path(name),
                    name: name.clone(),
                    info,
                    state: State::Orphaned,
                    is_pending: pending.contains(name),
                });
            }
        }
        found
    }

    /// Reads an accepted snapshot; if it cannot, reports why on stderr.
    pub fn accepted(&self, name: &Name, io: &Io) -> Readable {
        match self.folder.accepted(name) {
            Ok(accepted) => Readable::Yes(accepted.map(Box::new)),
            Err(error) => {
                let mut reported = self.reported.lock().unwrap_or_else(PoisonError::into_inner);
                if reported.insert(name.clone()) {
                    io.talk(&format!("note: {error}; it counts as changed"));
                }
                Readable::No
            }
        }
    }

    /// Reads a pending snapshot; an unreadable one counts as absent, since it is proposed again.
    pub fn pending(&self, name: &Name) -> Option<Snapshot> {
        self.folder.pending(name).ok().flatten()
    }

    /// Writes differences as pending, removes obsolete pending snapshots, and removes orphans if asked to.
    ///
    /// Updates in `states` which are pending.
    pub fn write(
        &mut self,
        states: &mut [SnapshotState],
        arguments: &SnapArguments,
    ) -> Result<(), Failure> {
        let mut operations = Vec::new();
        for found in states {
            let name = found.name.clone();
            match (found.state, self.expected.get(&name)) {
                (State::Changed | State::New, Some(Intended::Taken(taken))) => {
                    if self.pending(&name).as_ref() != Some(taken) {
                        operations.push(Operation::Propose(name, (**taken).clone()));
                    }
                    found.is_pending = true;
                }
                (State::Same, Some(Intended::Taken(_) | Intended::AsAccepted(_)))
                    if found.is_pending =>
                {
                    operations.push(Operation::Withdraw(name));
                    found.is_pending = false;
                }
                (State::Orphaned, _) if arguments.prune => operations.push(Operation::Remove(name)),
                _ => {}
            }
        }
        operations.extend(self.forgotten());
        self.folder.apply(&operations).map_err(Failure::environment)
    }

    /// Returns the operations that remove pending snapshots that were never accepted and are no longer declared.
    fn forgotten(&self) -> Vec<Operation> {
        let accepted: BTreeSet<&Name> = self.folder.accepted_names().collect();
        let mut operations = Vec::new();
        for name in self.folder.pending_names() {
            if self.expected.contains_key(name) || accepted.contains(name) {
                continue;
            }
            let metadata = self.pending(name).map(|pending| pending.metadata);
            let source = metadata.and_then(|it| it.info.and(it.source));
            if source.is_some_and(|source| self.sources.contains(&source)) {
                operations.push(Operation::Withdraw(name.clone()));
            }
        }
        operations
    }
}
