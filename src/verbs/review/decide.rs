//! Applies decisions: accepts and rejects snapshots.
//!
//! In: decisions about groups. Out: the decision for each snapshot, and changed folders. A snapshot is accepted when
//! all of its edits were accepted, and rejected when one was rejected. The snapshots of one folder change together or
//! not at all; with several folders, all are checked before the first one changes.

use super::find::{Pending, ReviewItems};
use super::groups::Group;
use crate::exit::Failure;
use crate::snapshots::{Operation, SnapshotError};
use fab_base::wording::quoted;
use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

/// The decision about a pending snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// It becomes the accepted one.
    Accept,
    /// It is removed; the accepted one stays.
    Reject,
}

/// The decisions that are still open for each pending snapshot.
pub struct OpenDecisions {
    /// How many groups of each snapshot are not accepted yet; `None` once the snapshot is settled.
    open: Vec<Option<usize>>,
    /// Snapshots with a decision about at least one of their groups.
    begun: BTreeSet<usize>,
}

impl OpenDecisions {
    /// Starts with all decisions open.
    pub fn of(n_pending: usize, groups: &[Group]) -> OpenDecisions {
        let mut open = vec![Some(0); n_pending];
        for member in groups.iter().flat_map(|group| &group.members) {
            if let Some(count) = &mut open[*member] {
                *count += 1;
            }
        }
        OpenDecisions {
            open,
            begun: BTreeSet::new(),
        }
    }

    /// Records the decision about a group once, and returns the snapshots that it settles.
    pub fn decide(&mut self, group: &Group, decision: Decision) -> Vec<(usize, Decision)> {
        let mut settled = Vec::new();
        for member in &group.members {
            let Some(count) = &mut self.open[*member] else {
                continue;
            };
            *count -= 1;
            self.begun.insert(*member);
            if decision == Decision::Reject || *count == 0 {
                settled.extend(self.settle(*member, decision));
            }
        }
        settled
    }

    /// Settles a snapshot regardless of its edits; returns `None` if it is already settled.
    pub fn settle(&mut self, member: usize, decision: Decision) -> Option<(usize, Decision)> {
        self.open[member].take().map(|_| (member, decision))
    }

    /// Returns the numbers of the snapshots with some edits accepted and others undecided.
    pub fn waiting(&self) -> Vec<usize> {
        let begun = self.begun.iter().copied();
        begun.filter(|member| !self.is_settled(*member)).collect()
    }

    /// Returns whether a snapshot is settled.
    pub fn is_settled(&self, member: usize) -> bool {
        self.open[member].is_none()
    }
}

/// Applies decisions about pending snapshots, by their numbers.
pub fn apply(found: &mut ReviewItems, decided: &[(usize, Decision)]) -> Result<(), Failure> {
    for (number, decision) in decided {
        let one = &found.pending[*number];
        if *decision == Decision::Accept {
            let now = found.folders[one.folder].pending(&one.name);
            if now.map_err(Failure::environment)?.as_ref() != Some(&one.proposed) {
                return Err(Failure::environment(SnapshotError::Changed {
                    path: one.path.clone(),
                }));
            }
        }
    }
    for (number, folder) in found.folders.iter_mut().enumerate() {
        let operations: Vec<Operation> = decided
            .iter()
            .map(|(at, decision)| (&found.pending[*at], *decision))
            .filter(|(one, _)| one.folder == number)
            .map(|(one, decision)| match decision {
                Decision::Accept => Operation::Accept(one.name.clone(), one.proposed.clone()),
                Decision::Reject => Operation::Withdraw(one.name.clone()),
            })
            .collect();
        folder.apply(&operations).map_err(Failure::environment)?;
    }
    Ok(())
}

/// The target of an id, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Selection {
    /// A group.
    Group(usize),
    /// A pending snapshot.
    Snapshot(usize),
}

/// Returns the target of an id; fails if there is none, or if several snapshots have this name.
pub fn named(id: &str, pending: &[Pending], groups: &[Group]) -> Result<Selection, Failure> {
    if let Some(group) = groups.iter().position(|group| group.id == id) {
        return Ok(Selection::Group(group));
    }
    let by_name = |one: &Pending| one.name.as_str() == id;
    let place = pending_path(id);
    let real = fs::canonicalize(&place).ok();
    let by_path = |one: &Pending| {
        one.path == place || (real.is_some() && fs::canonicalize(&one.path).ok() == real)
    };
    let numbers: Vec<usize> = (0..pending.len())
        .filter(|at| by_name(&pending[*at]) || by_path(&pending[*at]))
        .collect();
    match numbers.as_slice() {
        [] => Err(Failure::usage(format!(
            "nothing that is pending has the id `{id}`; `fabc review --json` lists them; nothing was done"
        ))),
        [one] => Ok(Selection::Snapshot(*one)),
        several => Err(Failure::usage(format!(
            "`{id}` names several snapshots: {}; name one by its path; nothing was done",
            quoted(several.iter().map(|at| pending[*at].path.display()))
        ))),
    }
}

/// Returns the path of the pending snapshot that a path refers to: its own, the accepted one's, or that of either
/// picture.
fn pending_path(id: &str) -> PathBuf {
    let file = id.strip_suffix(".png").unwrap_or(id);
    match file.ends_with(".snap") {
        true => PathBuf::from(format!("{file}.new")),
        false => PathBuf::from(file),
    }
}

/// Returns whether an id matches a pattern: contains it, or matches as a whole if it has `*` (any characters) or `?`
/// (one).
pub fn fits(pattern: &str, id: &str) -> bool {
    if !pattern.contains(['*', '?']) {
        return id.contains(pattern);
    }
    let pattern: Vec<char> = pattern.chars().collect();
    let id: Vec<char> = id.chars().collect();
    // The last `*` seen, and where in the id its match currently ends.
    let (mut at, mut star, mut next) = (0, None, 0);
    while next < id.len() {
        match pattern.get(at) {
            Some('*') => {
                star = Some((at, next));
                at += 1;
            }
            Some(letter) if *letter == '?' || *letter == id[next] => {
                at += 1;
                next += 1;
            }
            _ => match star {
                Some((starred, end)) => {
                    star = Some((starred, end + 1));
                    at = starred + 1;
                    next = end + 1;
                }
                None => return false,
            },
        }
    }
    pattern[at..].iter().all(|letter| *letter == '*')
}
