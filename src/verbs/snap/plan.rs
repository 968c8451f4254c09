//! What a folder of snapshots should hold, what it holds, and the change from one to the other.

use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{FOLDER, Folder, Info, Name, Operation, Snapshot};
use crate::verbs::snap::SnapArguments;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// What a folder of snapshots should hold.
pub struct Plan {
    /// The folder that holds the tasks.
    tasks: PathBuf,
    pub folder: Folder,
    wanted: BTreeMap<Name, Wanted>,
    /// The files that were looked at, as snapshots name them.
    sources: BTreeSet<String>,
    /// Which snapshots were said to be unreadable.
    told: Mutex<BTreeSet<Name>>,
}

/// What a snapshot should be.
pub enum Wanted {
    /// This.
    Taken(Box<Snapshot>),
    /// What it is: nothing that it is made from has changed.
    AsAccepted(Info),
    /// It should be there; this build cannot say what it should hold.
    Unseen(Info),
    /// It is there, and holds other bytes than it says; this build cannot draw it.
    Damaged(Info),
}

/// What became of reading an accepted snapshot.
pub enum Readable {
    /// It could be read, or is not there.
    Yes(Option<Box<Snapshot>>),
    /// It is there and cannot be read.
    No,
}

/// What was found out about one snapshot.
pub struct Found {
    /// Its name.
    pub name: Name,
    /// The accepted file, whether or not it is there.
    pub path: PathBuf,
    /// What it is of.
    pub info: Info,
    /// How the accepted one differs.
    pub state: State,
    /// Whether a pending one lies there, or is written now.
    pub is_pending: bool,
}

/// How an accepted snapshot differs from what is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Not at all.
    Same,
    /// This build cannot tell.
    Unseen,
    /// In what it holds.
    Changed,
    /// It is not there.
    New,
    /// It is there, and nothing is declared that it could be of.
    Orphaned,
}

impl State {
    /// Returns the word that scripts rely on.
    pub fn word(self) -> &'static str {
        match self {
            State::Same => "same",
            State::Unseen => "unseen",
            State::Changed => "changed",
            State::New => "new",
            State::Orphaned => "orphaned",
        }
    }
}

impl Found {
    /// Returns whether there is nothing to do about it.
    pub fn is_clean(&self) -> bool {
        matches!(self.state, State::Same | State::Unseen) && !self.is_pending
    }
}

impl Plan {
    /// Opens the snapshots of a folder of tasks.
    pub fn open(tasks: &Path) -> Result<Plan, Failure> {
        Ok(Plan {
            tasks: tasks.to_owned(),
            folder: Folder::open(tasks.join(FOLDER)).map_err(Failure::environment)?,
            wanted: BTreeMap::new(),
            sources: BTreeSet::new(),
            told: Mutex::default(),
        })
    }

    /// Says that a file was looked at whole.
    pub fn looked_at(&mut self, source: &str) {
        self.sources.insert(source.to_owned());
    }

    /// Says what a snapshot should be; fails where another file wants one of that name.
    pub fn want(&mut self, name: Name, wanted: Wanted) -> Result<(), Failure> {
        let is_taken = self.wanted.contains_key(&name);
        if is_taken {
            return Err(Failure::usage(format!(
                "two files declare what `{name}` would be a snapshot of; rename a task, or keep the files in two folders"
            )));
        }
        self.wanted.insert(name, wanted);
        Ok(())
    }

    /// Compares what is wanted with what is accepted, and finds what nobody wants.
    ///
    /// An accepted snapshot that cannot be read counts as changed, with a note: it is proposed anew.
    pub fn states(&self, io: &Io) -> Vec<Found> {
        let pending: BTreeSet<&Name> = self.folder.pending_names().collect();
        let mut found = Vec::with_capacity(self.wanted.len());
        for (name, wanted) in &self.wanted {
            let (info, state) = match wanted {
                Wanted::AsAccepted(info) => (info.clone(), State::Same),
                Wanted::Unseen(info) => (info.clone(), State::Unseen),
                Wanted::Damaged(info) => (info.clone(), State::Changed),
                Wanted::Taken(taken) => {
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
            found.push(Found {
                path: self.folder.accepted_path(name),
                name: name.clone(),
                info,
                state,
                is_pending: pending.contains(name),
            });
        }
        for name in self.folder.accepted_names() {
            if self.wanted.contains_key(name) {
                continue;
            }
            // What cannot be read is nobody's that is known here; it is left alone.
            let accepted = self.folder.accepted(name).ok().flatten();
            let Some(metadata) = accepted.map(|accepted| accepted.metadata) else {
                continue;
            };
            // Snapshots of others, such as a test suite's, are none of ours.
            let Some((source, info)) = metadata.source.zip(metadata.info) else {
                continue;
            };
            if self.sources.contains(&source) || !self.tasks.join(&source).exists() {
                found.push(Found {
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

    /// Reads an accepted snapshot; says on stderr why, where that is impossible.
    pub fn accepted(&self, name: &Name, io: &Io) -> Readable {
        match self.folder.accepted(name) {
            Ok(accepted) => Readable::Yes(accepted.map(Box::new)),
            Err(error) => {
                let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
                if told.insert(name.clone()) {
                    io.talk(&format!("note: {error}; it counts as changed"));
                }
                Readable::No
            }
        }
    }

    /// Reads a pending snapshot; one that cannot be read is none, for it is proposed anew.
    pub fn pending(&self, name: &Name) -> Option<Snapshot> {
        self.folder.pending(name).ok().flatten()
    }

    /// Writes what differs as pending, takes away what waits for nothing, and removes orphans where that is asked for.
    ///
    /// Says in `states` which are pending then.
    pub fn carry_out(
        &mut self,
        states: &mut [Found],
        arguments: &SnapArguments,
    ) -> Result<(), Failure> {
        let mut operations = Vec::new();
        for found in states {
            let name = found.name.clone();
            match (found.state, self.wanted.get(&name)) {
                (State::Changed | State::New, Some(Wanted::Taken(taken))) => {
                    if self.pending(&name).as_ref() != Some(taken) {
                        operations.push(Operation::Propose(name, (**taken).clone()));
                    }
                    found.is_pending = true;
                }
                (State::Same, Some(Wanted::Taken(_) | Wanted::AsAccepted(_)))
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

    /// Returns what takes away pending snapshots that were never accepted, and that nobody wants any more.
    fn forgotten(&self) -> Vec<Operation> {
        let accepted: BTreeSet<&Name> = self.folder.accepted_names().collect();
        let mut operations = Vec::new();
        for name in self.folder.pending_names() {
            if self.wanted.contains_key(name) || accepted.contains(name) {
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
