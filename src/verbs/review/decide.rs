//! Decisions about groups of pending snapshots, and what each snapshot comes to.
//!
//! In: decisions about groups. Out: the decision for each snapshot, and changed files. A snapshot is accepted when all of
//! its edits were accepted, and rejected when one was rejected; until then it waits.

use super::find::Pending;
use super::groups::Group;
use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{Name, Side};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// It becomes the accepted one.
    Accept,
    /// It is removed; the accepted one stays.
    Reject,
}

pub struct Decisions<'r> {
    pub pending: &'r [Pending],
    pub groups: &'r [Group],
    /// The decision about each group.
    made: Vec<Option<Decision>>,
    /// What was done with the file of each snapshot.
    settled: Vec<Option<Decision>>,
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
            made: vec![None; groups.len()],
            settled: vec![None; pending.len()],
        }
    }

    pub fn decide(&mut self, group: usize, decision: Decision) {
        self.made[group] = Some(decision);
    }

    /// Records a decision about the groups with these ids; fails if there is none, or it was decided otherwise.
    pub fn decide_named(&mut self, ids: &[String], decision: Decision) -> Result<(), Failure> {
        for id in ids {
            let Some(group) = self.groups.iter().position(|group| group.id == *id) else {
                return Err(Failure::usage(format!(
                    "no pending group has the id `{id}`; `fabc review --json` lists them; nothing was done"
                )));
            };
            if self.made[group].is_some_and(|earlier| earlier != decision) {
                return Err(Failure::usage(format!(
                    "`{id}` is both accepted and rejected; nothing was done"
                )));
            }
            self.decide(group, decision);
        }
        Ok(())
    }

    pub fn accept_others(&mut self) {
        for made in &mut self.made {
            made.get_or_insert(Decision::Accept);
        }
    }

    /// Changes the files of every snapshot that the decisions settle.
    pub fn apply(&mut self) -> Result<(), Failure> {
        for (at, one) in self.pending.iter().enumerate() {
            let open = self.settled[at].is_none();
            let Some(decision) = self.of(at).filter(|_| open) else {
                continue;
            };
            match decision {
                Decision::Accept => one.folder.accept(&one.name, &one.proposed)?,
                Decision::Reject => one.folder.remove(&one.name, Side::Pending)?,
            }
            self.settled[at] = Some(decision);
        }
        Ok(())
    }

    /// Returns whether the file of a snapshot was changed.
    pub fn is_settled(&self, member: usize) -> bool {
        self.settled[member].is_some()
    }

    pub fn outcome(&self) -> Outcome {
        let mut outcome = Outcome::default();
        for (at, one) in self.pending.iter().enumerate() {
            match self.settled[at] {
                Some(Decision::Accept) => outcome.accepted.push(one.name.clone()),
                Some(Decision::Reject) => outcome.rejected.push(one.name.clone()),
                None => {
                    outcome.n_pending += 1;
                    if self.of_groups(at).any(|decision| decision.is_some()) {
                        outcome.waiting.push(one.name.clone());
                    }
                }
            }
        }
        outcome
    }

    /// Returns what the decisions come to for a snapshot; `None` while some are open and none rejects it.
    fn of(&self, member: usize) -> Option<Decision> {
        let reject = Some(Decision::Reject);
        if self.of_groups(member).any(|decision| decision == reject) {
            return reject;
        }
        let is_accepted = self.of_groups(member).all(|decision| decision.is_some());
        is_accepted.then_some(Decision::Accept)
    }

    fn of_groups(&self, member: usize) -> impl Iterator<Item = Option<Decision>> {
        let groups = self.groups.iter().zip(&self.made);
        let own = groups.filter(move |(group, _)| group.members.contains(&member));
        own.map(|(_, decision)| *decision)
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
