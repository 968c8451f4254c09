//! What a folder of snapshots should hold, what it holds, and the change between them.

use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{self, FOLDER, Folder, Name, Side, Snapshot};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A snapshot that should exist, and what it should hold; `None` if this build cannot tell.
pub type Expected = (Name, Option<Snapshot>);

pub struct Plan {
    /// The folder that holds the tasks.
    tasks: PathBuf,
    pub folder: Folder,
    /// The accepted snapshots; `None` for one that cannot be read.
    accepted: BTreeMap<Name, Option<Snapshot>>,
    /// The pending snapshots that can be read; others are proposed again.
    pub pending: BTreeMap<Name, Snapshot>,
    expected: BTreeMap<Name, Option<Snapshot>>,
    /// The processed files, as snapshots name them.
    sources: BTreeSet<String>,
}

#[derive(Serialize)]
pub struct SnapshotState {
    #[serde(rename = "id")]
    pub name: Name,
    /// The accepted file, whether or not it exists.
    pub path: PathBuf,
    /// How the accepted snapshot differs.
    pub state: State,
    /// Whether a pending snapshot exists or is written now.
    #[serde(rename = "pending")]
    pub is_pending: bool,
}

/// How an accepted snapshot differs from what it should hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// It does not.
    Same,
    /// This build cannot tell.
    Unseen,
    /// Its contents differ, or it cannot be read.
    Changed,
    New,
    /// It exists, but nothing declares it any more.
    Orphaned,
}

impl Plan {
    /// Reads the snapshots of a folder of tasks, and reports those of `fabc` that cannot be read.
    pub fn open(tasks: &Path, io: &Io) -> Result<Plan, Failure> {
        let folder = Folder::open(tasks.join(FOLDER))?;
        let accepted = folder.accepted.iter().map(|name| {
            let accepted = folder.read(name, Side::Accepted);
            let accepted = accepted.unwrap_or_else(|why| {
                if snapshots::is_ours(name) {
                    io.talk(&format!("note: {why}; it counts as changed"));
                }
                None
            });
            (name.clone(), accepted)
        });
        let pending = folder.pending.iter().filter_map(|name| {
            let pending = folder.read(name, Side::Pending).ok()??;
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
    pub fn expect(&mut self, source: &str, expected: Vec<Expected>) -> Result<(), Failure> {
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

    pub fn accepted(&self, name: &str) -> Option<&Snapshot> {
        self.accepted.get(name)?.as_ref()
    }

    /// Returns the states of the expected snapshots, and of orphans.
    pub fn states(&self) -> Vec<SnapshotState> {
        let state = |(name, state): (&Name, State)| SnapshotState {
            path: self.folder.file(name, Side::Accepted),
            name: name.clone(),
            state,
            is_pending: self.folder.pending.contains(name),
        };
        let expected = self.expected.iter();
        let expected = expected.map(|(name, taken)| (name, self.compared(name, taken.as_ref())));
        let accepted = self.accepted.iter();
        let accepted = accepted.filter_map(|(name, it)| Some((name, it.as_ref()?)));
        let orphans = self.undeclared(accepted).filter(|(_, source)| {
            self.sources.contains(*source) || !self.tasks.join(source).exists()
        });
        let orphans = orphans.map(|(name, _)| (name, State::Orphaned));
        expected.chain(orphans).map(state).collect()
    }

    /// Compares the accepted snapshot with what it should hold.
    fn compared(&self, name: &str, taken: Option<&Snapshot>) -> State {
        match (self.accepted.get(name), taken) {
            (_, None) => State::Unseen,
            (None, _) => State::New,
            (Some(Some(accepted)), Some(taken)) if accepted.contents.is_same(&taken.contents) => {
                State::Same
            }
            _ => State::Changed,
        }
    }

    /// Returns the snapshots that are not expected, with their sources; those of other tools have neither source nor details.
    fn undeclared<'s>(
        &self,
        snapshots: impl Iterator<Item = (&'s Name, &'s Snapshot)>,
    ) -> impl Iterator<Item = (&'s Name, &'s str)> {
        let undeclared = snapshots.filter(|(name, _)| !self.expected.contains_key(*name));
        undeclared.filter_map(|(name, snapshot)| {
            snapshot.metadata.info.as_ref()?;
            Some((name, snapshot.metadata.source.as_deref()?))
        })
    }

    /// Writes differences as pending, removes what need not be pending, and orphans if asked to; updates what is pending.
    pub fn write(&self, states: &mut [SnapshotState], prunes: bool) -> Result<(), Failure> {
        for found in states {
            let name = &found.name;
            let taken = self.expected.get(name).and_then(Option::as_ref);
            match (found.state, taken) {
                (State::Changed | State::New, Some(taken)) => {
                    if self.pending.get(name) != Some(taken) {
                        self.folder.propose(name, taken)?;
                    }
                    found.is_pending = true;
                }
                (State::Same, _) if found.is_pending => {
                    self.folder.remove(name, Side::Pending)?;
                    found.is_pending = false;
                }
                (State::Orphaned, _) if prunes => self.folder.remove(name, Side::Accepted)?,
                _ => {}
            }
        }
        for (name, source) in self.undeclared(self.pending.iter()) {
            if self.sources.contains(source) {
                self.folder.remove(name, Side::Pending)?;
            }
        }
        Ok(())
    }
}
