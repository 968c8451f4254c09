//! The person beside the arm, and what keeps watch when nobody answers.
//!
//! In: what is about to move. Out: leave to do it, or not. Who asks on a terminal is the command's business; here are the
//! questions, and supervisors that need no person for arms that are simulated.

use super::route::Segment;
use fab_world::start::Start;
use nalgebra::Point3;

/// What is about to happen.
#[derive(Clone, Copy, Debug)]
pub enum Asked<'a> {
    /// A whole pick and place.
    Action {
        /// From 1.
        number: u32,
        /// Where it picks and places, metres, base frame.
        points: [Point3<f64>; 2],
        /// Its parts.
        segments: &'a [Segment],
    },
    /// One part of it.
    Segment(&'a Segment),
}

/// A person who watches the arm.
pub trait Supervisor {
    /// Lays the cloth on the table as a rollout begins; says whether it lies there.
    fn lays_cloth(&mut self, start: &Start) -> bool;

    /// Gives leave, or not.
    fn allows(&mut self, asked: Asked<'_>) -> bool;

    /// Tells whether motion may go on right now: whether the key is held, where one has to be.
    fn is_holding(&mut self) -> bool {
        true
    }
}

/// Gives leave to everything: for arms that are simulated, and for those who said `--confirm none`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unattended;

impl Supervisor for Unattended {
    fn lays_cloth(&mut self, _: &Start) -> bool {
        true
    }

    fn allows(&mut self, _: Asked<'_>) -> bool {
        true
    }
}

/// Stops the arm from outside when this program gives no sign of life while the arm moves.
pub trait Watchdog {
    /// Begins to keep watch; fails where it cannot.
    fn watch(&mut self) -> Result<(), String>;

    /// Gives a sign of life; fails where nobody heard it.
    fn beat(&mut self) -> Result<(), String>;

    /// Ends the watch: the arm is at rest.
    fn rest(&mut self);
}

/// Keeps no watch: for arms that are simulated in this program and end with it.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoWatchdog;

impl Watchdog for NoWatchdog {
    fn watch(&mut self) -> Result<(), String> {
        Ok(())
    }

    fn beat(&mut self) -> Result<(), String> {
        Ok(())
    }

    fn rest(&mut self) {}
}
