//! Decisions about groups of pending snapshots.
//!
//! In: groups, and decisions about them. Out: changed files, and the names of the snapshots. Each snapshot is in one
//! group, so a decision settles it at once.

use super::ReviewArguments;
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

/// Returns the decisions that the command line names; fails if there is no group of an id, or an id is named twice.
pub fn named<'g>(
    groups: &'g [Group],
    arguments: &ReviewArguments,
) -> Result<Vec<(&'g Group, Decision)>, Failure> {
    let ReviewArguments { accept, reject, .. } = arguments;
    for id in accept.iter().chain(reject) {
        if !groups.iter().any(|group| group.id == *id) {
            return Err(Failure::usage(format!(
                "no pending group has the id `{id}`; `fabc review --json` lists them; nothing was done"
            )));
        }
        if accept.contains(id) && reject.contains(id) {
            return Err(Failure::usage(format!(
                "`{id}` is both accepted and rejected; nothing was done"
            )));
        }
    }
    let decisions = groups.iter().filter_map(|group| {
        let is_accepted = arguments.accept_all || accept.contains(&group.id);
        let decision = if reject.contains(&group.id) {
            Decision::Reject
        } else if is_accepted {
            Decision::Accept
        } else {
            return None;
        };
        Some((group, decision))
    });
    Ok(decisions.collect())
}

/// What the decisions of a review came to.
#[derive(Default)]
pub struct Outcome {
    pub accepted: Vec<Name>,
    pub rejected: Vec<Name>,
}

impl Outcome {
    /// Changes the files of a group's snapshots.
    pub fn apply(
        &mut self,
        decision: Decision,
        group: &Group,
        pending: &[Pending],
    ) -> Result<(), Failure> {
        for one in group.members.iter().map(|at| &pending[*at]) {
            match decision {
                Decision::Accept => {
                    one.folder.accept(&one.name, &one.proposed)?;
                    self.accepted.push(one.name.clone());
                }
                Decision::Reject => {
                    one.folder.remove(&one.name, Side::Pending)?;
                    self.rejected.push(one.name.clone());
                }
            }
        }
        Ok(())
    }

    /// Tells what was done; `n_pending`: how many there were before.
    pub fn report(&self, n_pending: usize, io: &Io) {
        let [accepted, rejected] = [&self.accepted, &self.rejected].map(Vec::len);
        let n_pending = n_pending - accepted - rejected;
        io.data(&format!(
            "accepted {accepted}, rejected {rejected}, still pending {n_pending}"
        ));
    }
}
