//! Faults that can be injected into a simulated arm, for tests and rehearsals.

use serde::{Deserialize, Serialize};

/// A fault that occurs once, at or after a time of the arm's clock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// The fault.
    pub kind: FaultKind,
    /// Its earliest time, seconds.
    pub from_s: f64,
}

fab_base::named! {
    /// A kind of fault.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum FaultKind {
        /// The next goal does not arrive.
        LostGoal = "lost_goal",
        /// The next three goals do not arrive.
        LostGoals = "lost_goals",
        /// The result of the next goal does not arrive.
        LostResult = "lost_result",
        /// Nothing is heard of the next goal that causes a motion, which is carried out.
        LostStatus = "lost_status",
        /// The next cancellation does not arrive.
        LostCancel = "lost_cancel",
        /// The next stop gets no answer and has no effect.
        LostStop = "lost_stop",
        /// No reading arrives from then on.
        Silence = "silence",
        /// No reading arrives for 0.6 s.
        ShortSilence = "short_silence",
        /// The last reading is published again and again, with its stamp, from then on.
        RepeatedReading = "repeated_reading",
        /// The arm jams during a motion and never moves again.
        StuckJoint = "stuck_joint",
        /// Somebody presses the stop.
        PressedStop = "pressed_stop",
        /// The next motion ends 7 mm short of its goal, and the node reports it as reached.
        FallsShort = "falls_short",
        /// Every motion ends 7 mm short.
        FallsShortAlways = "falls_short_always",
        /// The node aborts the next goal that causes a motion.
        AbortedGoal = "aborted_goal",
        /// The arm leaves its path and keeps turning.
        Runaway = "runaway",
        /// The fingers never move again.
        StuckFingers = "stuck_fingers",
        /// The camera never delivers a picture again.
        NoPicture = "no_picture",
    }
}

/// Pending and active faults of an arm.
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

    /// Adds a pending fault.
    pub(super) fn add(&mut self, fault: Fault) {
        self.pending.push(fault);
    }

    /// Consumes a due one-time fault of a kind; returns whether there was one.
    pub(super) fn take(&mut self, kind: FaultKind, now_s: f64) -> bool {
        let due = |fault: &Fault| fault.kind == kind && fault.from_s <= now_s;
        let Some(index) = self.pending.iter().position(due) else {
            return false;
        };
        self.pending.remove(index);
        true
    }

    /// Returns whether a goal that is sent now is lost.
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

    /// Returns whether a lasting fault of a kind has started.
    pub(super) fn is_active(&mut self, kind: FaultKind, now_s: f64) -> bool {
        if self.take(kind, now_s) {
            self.lasting.push(kind);
        }
        self.lasting.contains(&kind)
    }

    /// Returns the start time of a pending fault of a kind.
    pub(super) fn since_s(&self, kind: FaultKind) -> Option<f64> {
        let fault = self.pending.iter().find(|fault| fault.kind == kind);
        fault.map(|fault| fault.from_s)
    }
}
