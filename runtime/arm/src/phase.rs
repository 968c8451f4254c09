//! The phases of an arm, and the events that lead from one to another.
//!
//! One machine for all who ask whether an arm may move: the driver keeps the phase while a program runs, and refuses
//! motions of a stopped arm. The lines of the journal are the same events, so that the next program knows in which
//! phase the last one left the arm. `docs/arm.md` has the diagram.

use serde::Serialize;

/// What an arm may do next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// It rests where it was told to, and takes motions.
    #[default]
    Ready,
    /// A motion was begun, and is not verified. An arm whose program has ended was left in the middle of it.
    Moving,
    /// It rests within a motion, and takes the rest of it.
    Paused,
    /// It was stopped, and takes no motion until a person has recovered it.
    Stopped,
}

/// What happens to an arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A motion begins.
    Begin,
    /// It was measured to have ended where it should, at rest.
    Verify,
    /// The hold-to-run key was released, and the arm was measured at rest.
    Pause,
    /// This program, its watchdog or a person stopped it.
    Stop,
    /// A person has seen to it, and lets it move again.
    Recover,
}

impl Phase {
    /// Returns the phase after an event.
    #[must_use]
    pub fn after(self, event: Event) -> Phase {
        match (self, event) {
            (_, Event::Stop) => Phase::Stopped,
            (_, Event::Recover) => Phase::Ready,
            (Phase::Stopped, _) => Phase::Stopped,
            (_, Event::Begin) => Phase::Moving,
            (_, Event::Verify) => Phase::Ready,
            (_, Event::Pause) => Phase::Paused,
        }
    }

    /// Returns whether the arm takes motions.
    pub fn takes_motions(self) -> bool {
        self != Phase::Stopped
    }
}
