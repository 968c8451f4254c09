//! Tests of `action.rs`.

use super::*;

#[test]
fn ids_are_unique_and_read_back() {
    let ids: Vec<Id> = (0..100).map(|_| unique_id()).collect();
    for (index, id) in ids.iter().enumerate() {
        assert_eq!(id_of(&text_of(id)), Some(*id));
        assert!(!ids[..index].contains(id));
    }
    for other in ["", "zz", "never sent", &"0".repeat(31)] {
        assert_eq!(id_of(other), None, "{other}");
    }
}

#[test]
fn a_goal_that_has_ended_stays_so() {
    let mut ledger = Ledger::default();
    ledger.goals.insert([1; 16], GoalState::Sent);
    ledger.update([2; 16], 4);
    for (status, expected) in [
        (2, GoalState::Active),
        (5, GoalState::Ended(Ending::Preempted)),
        (4, GoalState::Ended(Ending::Preempted)),
        (2, GoalState::Ended(Ending::Preempted)),
    ] {
        ledger.update([1; 16], status);
        assert_eq!(ledger.goals.get(&[1; 16]), Some(&expected));
    }
    assert_eq!(ledger.goals.len(), 1, "only what was sent is noted");
}
