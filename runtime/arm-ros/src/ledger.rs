//! The states of the goals of one action server.
//!
//! In: goals that were sent, and the server's status lists and results. Out: the state of each goal. Any single message
//! may be lost: a list repeats what a lost result reported, and an active goal that a list no longer names has ended.

use super::messages::actionlib_msgs::{GoalStatus, GoalStatusArray};
use fab_arm::port::{Ending, GoalState};
use std::collections::BTreeMap;

/// The goals of one action server, and their states.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    goals: BTreeMap<String, GoalState>,
}

impl Ledger {
    /// Adds a goal before it is sent, so that no answer comes too early.
    pub(super) fn add(&mut self, id: &str) {
        self.goals.insert(id.to_owned(), GoalState::Sent);
    }

    /// Removes a goal.
    pub(super) fn remove(&mut self, id: &str) {
        self.goals.remove(id);
    }

    /// Returns the state of a goal, if it was ever added.
    pub(super) fn state(&self, id: &str) -> Option<GoalState> {
        self.goals.get(id).cloned()
    }

    /// Returns the goals that are not over.
    pub(super) fn open(&self) -> Vec<String> {
        let open = self.goals.iter().filter(|(_, state)| !is_over(state));
        open.map(|(id, _)| id.clone()).collect()
    }

    /// Updates all goals from the list that the server publishes several times a second.
    pub(super) fn update_from_list(&mut self, list: &GoalStatusArray) {
        for status in &list.status_list {
            self.update(status);
        }
        for (id, state) in &mut self.goals {
            let listed = || {
                list.status_list
                    .iter()
                    .any(|status| status.goal_id.id == *id)
            };
            // A goal that was just sent is not listed yet; one that was active must be, until long after its end.
            if *state == GoalState::Active && !listed() {
                *state = GoalState::Ended(Ending::Aborted);
            }
        }
    }

    /// Updates one goal from a list or a result. A goal that has ended keeps its ending.
    pub(super) fn update(&mut self, status: &GoalStatus) {
        let Some(state) = self.goals.get_mut(&status.goal_id.id) else {
            return;
        };
        if is_over(state) {
            return;
        }
        *state = match status.status {
            GoalStatus::PENDING
            | GoalStatus::ACTIVE
            | GoalStatus::PREEMPTING
            | GoalStatus::RECALLING => GoalState::Active,
            GoalStatus::SUCCEEDED => GoalState::Ended(Ending::Succeeded),
            GoalStatus::PREEMPTED | GoalStatus::RECALLED => GoalState::Ended(Ending::Preempted),
            GoalStatus::REJECTED => GoalState::Ended(Ending::Rejected),
            GoalStatus::ABORTED | GoalStatus::LOST => GoalState::Ended(Ending::Aborted),
            _ => return,
        };
    }
}

fn is_over(state: &GoalState) -> bool {
    matches!(state, GoalState::Ended(_))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::messages::actionlib_msgs::GoalID;
    use proptest::prelude::*;

    /// Goals with their codes, as in one list of the server.
    type Entries = &'static [(&'static str, u8)];

    fn status(id: &str, status: u8) -> GoalStatus {
        GoalStatus {
            goal_id: GoalID {
                id: id.to_owned(),
                ..GoalID::default()
            },
            status,
            ..GoalStatus::default()
        }
    }

    fn list(entries: &[(&str, u8)]) -> GoalStatusArray {
        GoalStatusArray {
            status_list: entries.iter().map(|(id, code)| status(id, *code)).collect(),
            ..GoalStatusArray::default()
        }
    }

    /// The goal's state after these lists in a ledger that has sent `a`; an empty list names no goal at all.
    fn after(lists: &[Entries]) -> GoalState {
        let mut ledger = Ledger::default();
        ledger.add("a");
        for entries in lists {
            ledger.update_from_list(&list(entries));
        }
        ledger.state("a").unwrap()
    }

    #[test]
    fn each_status_has_its_state() {
        use Ending::{Aborted, Preempted, Rejected, Succeeded};
        use GoalState::{Active, Ended, Sent};
        let cases: [(&[Entries], GoalState); 14] = [
            (&[], Sent),
            (&[&[]], Sent),
            (&[&[("b", 3)]], Sent),
            (&[&[("a", 0)]], Active),
            (&[&[("a", 1)]], Active),
            (&[&[("a", 6)]], Active),
            (&[&[("a", 2)]], Ended(Preempted)),
            (&[&[("a", 3)]], Ended(Succeeded)),
            (&[&[("a", 4)]], Ended(Aborted)),
            (&[&[("a", 5)]], Ended(Rejected)),
            (&[&[("a", 8)]], Ended(Preempted)),
            (&[&[("a", 77)]], Sent),
            (&[&[("a", 1)], &[]], Ended(Aborted)),
            (&[&[("a", 1)], &[("a", 3)], &[]], Ended(Succeeded)),
        ];
        for (lists, expected) in cases {
            assert_eq!(after(lists), expected, "{lists:?}");
        }
    }

    #[test]
    fn a_goal_is_open_until_it_ends() {
        let mut ledger = Ledger::default();
        ledger.add("a");
        ledger.add("b");
        ledger.update(&status("a", 4));
        assert_eq!(ledger.open(), ["b"]);
        assert_eq!(ledger.state("c"), None);
    }

    proptest! {
        /// Whatever a server reports, in whatever order, an ended goal keeps its ending.
        #[test]
        fn an_ending_is_never_taken_back(codes in prop::collection::vec(prop::option::of(0_u8..12), 0..20)) {
            let mut ledger = Ledger::default();
            ledger.add("a");
            let mut ended = None;
            for code in codes {
                match code {
                    Some(code) => ledger.update_from_list(&list(&[("a", code)])),
                    None => ledger.update_from_list(&list(&[])),
                }
                let state = ledger.state("a").unwrap();
                if let Some(ended) = &ended {
                    prop_assert_eq!(&state, ended);
                }
                if is_over(&state) {
                    ended = Some(state);
                }
            }
        }
    }
}
