//! What can go wrong with an arm, for tests and rehearsals.

use serde::{Deserialize, Serialize};

/// Something that goes wrong, once, at or after a time of the arm's clock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// What goes wrong.
    pub kind: FaultKind,
    /// From when on, seconds.
    pub from_s: f64,
}

/// A kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// The next goal does not arrive.
    LostGoal,
    /// The next three goals do not arrive.
    LostGoals,
    /// The word that the next goal is over does not arrive.
    LostResult,
    /// The next cancellation does not arrive.
    LostCancel,
    /// The next stop gives no answer, and has no effect.
    LostStop,
    /// No reading arrives any more.
    Silence,
    /// No reading arrives for 0.6 s.
    ShortSilence,
    /// The arm comes to a stop on its way and moves no more.
    StuckJoint,
    /// Somebody presses the stop.
    PressedStop,
    /// The next motion comes to rest 7 mm short of its goal, which the node calls reached.
    FallsShort,
    /// Every motion does.
    FallsShortAlways,
    /// The node gives the next goal up.
    AbortedGoal,
    /// The arm turns away from its way, without end.
    Runaway,
    /// The fingers do not move any more.
    StuckFingers,
    /// The camera gives no picture any more.
    NoPicture,
}

impl FaultKind {
    /// Lists every kind.
    pub const ALL: [FaultKind; 15] = [
        FaultKind::LostGoal,
        FaultKind::LostGoals,
        FaultKind::LostResult,
        FaultKind::LostCancel,
        FaultKind::LostStop,
        FaultKind::Silence,
        FaultKind::ShortSilence,
        FaultKind::StuckJoint,
        FaultKind::PressedStop,
        FaultKind::FallsShort,
        FaultKind::FallsShortAlways,
        FaultKind::AbortedGoal,
        FaultKind::Runaway,
        FaultKind::StuckFingers,
        FaultKind::NoPicture,
    ];
}

/// The faults of an arm that are yet to come or have come.
#[derive(Clone, Debug, Default)]
pub(super) struct Faults {
    pending: Vec<Fault>,
    lasting: Vec<FaultKind>,
    /// How many of the next goals do not arrive.
    goals_to_lose: u32,
}

impl Faults {
    pub(super) fn new(faults: Vec<Fault>) -> Faults {
        Faults {
            pending: faults,
            ..Faults::default()
        }
    }

    /// Adds one that is yet to come.
    pub(super) fn add(&mut self, fault: Fault) {
        self.pending.push(fault);
    }

    /// Takes a fault of a kind that is due and happens once; tells whether there was one.
    pub(super) fn take(&mut self, kind: FaultKind, now_s: f64) -> bool {
        let due = |fault: &Fault| fault.kind == kind && fault.from_s <= now_s;
        let Some(index) = self.pending.iter().position(due) else {
            return false;
        };
        self.pending.remove(index);
        true
    }

    /// Tells whether a goal that is sent now is lost.
    pub(super) fn loses_goal(&mut self, now_s: f64) -> bool {
        if self.take(FaultKind::LostGoals, now_s) {
            self.goals_to_lose += 3;
        }
        if self.take(FaultKind::LostGoal, now_s) {
            self.goals_to_lose += 1;
        }
        let is_lost = self.goals_to_lose > 0;
        self.goals_to_lose = self.goals_to_lose.saturating_sub(1);
        is_lost
    }

    /// Tells whether a fault of a kind that lasts has begun.
    pub(super) fn lasts(&mut self, kind: FaultKind, now_s: f64) -> bool {
        if self.take(kind, now_s) {
            self.lasting.push(kind);
        }
        self.lasting.contains(&kind)
    }

    /// Returns since when a fault has been due that is looked at again and again.
    pub(super) fn since_s(&self, kind: FaultKind) -> Option<f64> {
        let fault = self.pending.iter().find(|fault| fault.kind == kind);
        fault.map(|fault| fault.from_s)
    }
}
