//! Decisions about pending snapshots: what each comes to, and what an id names.
//!
//! In: decisions about groups and about snapshots. Out: the decision for each snapshot, and changed files. A snapshot is
//! accepted when all of its edits were accepted, and rejected when one was rejected; until then it waits.

use super::find::Pending;
use super::groups::Group;
use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{Name, Side};
use fab_base::wording::quoted;
use std::collections::BTreeMap;
use std::path::PathBuf;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// It becomes the accepted one.
    Accept,
    /// It is removed; the accepted one stays.
    Reject,
}

/// The target of a decision, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Selection {
    Group(usize),
    Snapshot(usize),
}

pub struct Decisions<'r> {
    pub pending: &'r [Pending],
    pub groups: &'r [Group],
    made: BTreeMap<Selection, Decision>,
    /// The snapshots whose files were changed.
    settled: BTreeMap<usize, Decision>,
}

/// What the decisions of a review came to.
#[derive(Default)]
pub struct Outcome {
    pub accepted: Vec<Name>,
    pub rejected: Vec<Name>,
    /// Those of which only some edits were accepted; they are still pending.
    pub waiting: Vec<Name>,
    pub n_pending: usize,
}

impl<'r> Decisions<'r> {
    pub fn about(pending: &'r [Pending], groups: &'r [Group]) -> Decisions<'r> {
        Decisions {
            pending,
            groups,
            made: BTreeMap::new(),
            settled: BTreeMap::new(),
        }
    }

    pub fn decide(&mut self, group: usize, decision: Decision) {
        self.made.insert(Selection::Group(group), decision);
    }

    /// Records a decision about all that the ids name; fails if one names nothing, or something that was decided otherwise.
    pub fn decide_named(&mut self, ids: &[String], decision: Decision) -> Result<(), Failure> {
        for id in ids {
            let earlier = self.made.insert(self.named(id)?, decision);
            if earlier.is_some_and(|earlier| earlier != decision) {
                return Err(Failure::usage(format!(
                    "`{id}` is both accepted and rejected; nothing was done"
                )));
            }
        }
        Ok(())
    }

    pub fn accept_others(&mut self) {
        for group in (0..self.groups.len()).map(Selection::Group) {
            self.made.entry(group).or_insert(Decision::Accept);
        }
    }

    /// Changes the files of every snapshot that the decisions settle.
    pub fn apply(&mut self) -> Result<(), Failure> {
        for (at, one) in self.pending.iter().enumerate() {
            let Some(decision) = self.of(at).filter(|_| !self.is_settled(at)) else {
                continue;
            };
            match decision {
                Decision::Accept => one.folder.accept(&one.name, &one.proposed)?,
                Decision::Reject => one.folder.remove(&one.name, Side::Pending)?,
            }
            self.settled.insert(at, decision);
        }
        Ok(())
    }

    /// Returns whether the file of a snapshot was changed.
    pub fn is_settled(&self, member: usize) -> bool {
        self.settled.contains_key(&member)
    }

    pub fn outcome(&self) -> Outcome {
        let mut outcome = Outcome::default();
        for (at, one) in self.pending.iter().enumerate() {
            let names = match self.settled.get(&at) {
                Some(Decision::Accept) => &mut outcome.accepted,
                Some(Decision::Reject) => &mut outcome.rejected,
                None => {
                    outcome.n_pending += 1;
                    // Some of its edits are accepted, and others undecided.
                    let is_waiting = self.of_groups(at).any(|it| it.is_some());
                    if !is_waiting || self.of(at).is_some() {
                        continue;
                    }
                    &mut outcome.waiting
                }
            };
            names.push(one.name.clone());
        }
        outcome
    }

    /// Returns what the decisions come to for a snapshot; `None` while some are open.
    fn of(&self, member: usize) -> Option<Decision> {
        let of_groups: Vec<Option<Decision>> = self.of_groups(member).collect();
        if of_groups.contains(&Some(Decision::Reject)) {
            return Some(Decision::Reject);
        }
        if let Some(own) = self.made.get(&Selection::Snapshot(member)) {
            return Some(*own);
        }
        let is_accepted = of_groups.iter().all(Option::is_some);
        is_accepted.then_some(Decision::Accept)
    }

    fn of_groups(&self, member: usize) -> impl Iterator<Item = Option<Decision>> {
        let groups = self.groups.iter().enumerate();
        let own = groups.filter(move |(_, group)| group.members.contains(&member));
        own.map(|(number, _)| self.made.get(&Selection::Group(number)).copied())
    }

    /// Returns what an id names: a group's, a snapshot's, or the path of a snapshot, pending or accepted, or of its picture.
    fn named(&self, id: &str) -> Result<Selection, Failure> {
        if let Some(group) = self.groups.iter().position(|group| group.id == id) {
            return Ok(Selection::Group(group));
        }
        let path = id.trim_end_matches(".png").trim_end_matches(".new");
        let path = PathBuf::from(format!("{path}.new"));
        let pending = self.pending.iter().enumerate();
        let found = pending.filter(|(_, one)| one.name == id || one.path == path);
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
}

impl Outcome {
    pub fn report(&self, io: &Io) {
        let (accepted, rejected) = (self.accepted.len(), self.rejected.len());
        let (n_waiting, n_pending) = (self.waiting.len(), self.n_pending);
        if n_waiting > 0 {
            io.talk(&format!(
                "{}; decide about all of them at once, since single ones are not remembered",
                waiting(n_waiting)
            ));
        }
        io.data(&format!(
            "accepted {accepted}, rejected {rejected}, still pending {n_pending}"
        ));
    }
}

/// Reports snapshots of which only some edits are accepted.
pub fn waiting(count: usize) -> String {
    match count {
        1 => "1 snapshot waits until its other edits are decided".to_owned(),
        _ => format!("{count} snapshots wait until their other edits are decided"),
    }
}
