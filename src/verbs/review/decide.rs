//! Decisions about pending snapshots: what each comes to, and what an id names.
//!
//! In: decisions about groups and about snapshots. Out: the decision for each snapshot, and changed files. A snapshot is
//! accepted when all of its edits were accepted, and rejected when one was rejected; until then it waits.

use super::find::Pending;
use super::groups::Group;
use crate::exit::Failure;
use crate::snapshots::Side;
use fab_base::wording::quoted;
use std::collections::BTreeMap;
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

/// The target of an id, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Selection {
    /// A group.
    Group(usize),
    /// A pending snapshot.
    Snapshot(usize),
}

/// All decisions so far.
pub struct Decisions<'g> {
    groups: &'g [Group],
    made: BTreeMap<Selection, Decision>,
}

impl<'g> Decisions<'g> {
    /// Starts without a decision.
    pub fn about(groups: &'g [Group]) -> Decisions<'g> {
        Decisions {
            groups,
            made: BTreeMap::new(),
        }
    }

    /// Records a decision; returns an earlier one about the same.
    pub fn decide(&mut self, what: Selection, decision: Decision) -> Option<Decision> {
        self.made.insert(what, decision)
    }

    /// Returns what the decisions come to for a snapshot; `None` while some are open.
    pub fn of(&self, member: usize) -> Option<Decision> {
        let of_groups: Vec<Option<Decision>> = self.of_groups(member).collect();
        if of_groups.contains(&Some(Decision::Reject)) {
            return Some(Decision::Reject);
        }
        if let Some(own) = self.made.get(&Selection::Snapshot(member)) {
            return Some(*own);
        }
        let is_accepted = of_groups.iter().all(|it| *it == Some(Decision::Accept));
        is_accepted.then_some(Decision::Accept)
    }

    /// Returns whether some edits of a snapshot are accepted, and others undecided.
    pub fn is_waiting(&self, member: usize) -> bool {
        self.of(member).is_none() && self.of_groups(member).any(|it| it.is_some())
    }

    fn of_groups(&self, member: usize) -> impl Iterator<Item = Option<Decision>> {
        let groups = self.groups.iter().enumerate();
        let own = groups.filter(move |(_, group)| group.members.contains(&member));
        own.map(|(number, _)| self.made.get(&Selection::Group(number)).copied())
    }
}

/// Carries out the decision about a pending snapshot.
pub fn apply(one: &Pending, decision: Decision) -> Result<(), Failure> {
    let applied = match decision {
        Decision::Accept => one.folder.accept(&one.name, &one.proposed),
        Decision::Reject => one.folder.remove(&one.name, Side::Pending),
    };
    applied.map_err(Failure::environment)
}

/// Returns the target of an id; fails if there is none, or if several snapshots have this name.
pub fn named(id: &str, pending: &[Pending], groups: &[Group]) -> Result<Selection, Failure> {
    if let Some(group) = groups.iter().position(|group| group.id == id) {
        return Ok(Selection::Group(group));
    }
    let real = fs::canonicalize(pending_path(id)).ok();
    let is_named = |one: &Pending| {
        one.name.0 == id || (real.is_some() && fs::canonicalize(&one.path).ok() == real)
    };
    let found = pending.iter().enumerate().filter(|(_, one)| is_named(one));
    match found.collect::<Vec<_>>().as_slice() {
        [] => Err(Failure::usage(format!(
            "nothing that is pending has the id `{id}`; `fabc review --json` lists them; nothing was done"
        ))),
        [(one, _)] => Ok(Selection::Snapshot(*one)),
        several => Err(Failure::usage(format!(
            "`{id}` names several snapshots: {}; name one by its path; nothing was done",
            quoted(several.iter().map(|(_, one)| one.path.display()))
        ))),
    }
}

/// Returns the path of the pending snapshot that a path refers to: its own, the accepted one's, or that of either
/// picture.
fn pending_path(id: &str) -> PathBuf {
    let file = id.strip_suffix(".png").unwrap_or(id);
    if file.ends_with(".snap") {
        PathBuf::from(format!("{file}.new"))
    } else {
        PathBuf::from(file)
    }
}
