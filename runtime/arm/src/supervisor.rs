//! The supervisor who confirms motion, and the watchdog that stops the arm if this program hangs.
//!
//! In: what is about to move. Out: confirmation, or not. Asking on a terminal is left to the command; here are the
//! traits, and implementations that need no person, for simulated arms.

use super::route::Segment;
use fab_world::start::Start;
use nalgebra::Point3;

/// A motion that needs confirmation.
#[derive(Clone, Copy, Debug)]
pub enum MotionRequest<'a> {
    /// A whole pick and place.
    Action {
        /// Its number within the run, from 1.
        number: u32,
        /// Pick and place, metres, base frame.
        points: [Point3<f64>; 2],
        /// Its segments.
        segments: &'a [Segment],
    },
    /// One segment of it.
    Segment(&'a Segment),
}

/// Decides whether the arm may move: a person, or a stand-in for one.
pub trait Supervisor {
    /// Asks for the cloth to be laid on the table as a rollout starts; returns whether it lies there.
    fn confirm_cloth(&mut self, start: &Start) -> bool;

    /// Returns whether a motion is confirmed.
    fn confirm(&mut self, request: MotionRequest<'_>) -> bool;

    /// Returns whether motion may continue right now, e.g. whether the hold-to-run key is down.
    fn motion_allowed(&mut self) -> bool {
        true
    }
}

/// Confirms everything: for simulated arms, and for `--confirm none`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unattended;

impl Supervisor for Unattended {
    fn confirm_cloth(&mut self, _: &Start) -> bool {
        true
    }

    fn confirm(&mut self, _: MotionRequest<'_>) -> bool {
        true
    }
}

/// Stops the arm from outside if this program sends no heartbeat while the arm moves.
pub trait Watchdog {
    /// Starts watching, and waits until that is acknowledged; fails if it is not.
    fn watch(&mut self) -> Result<(), String>;

    /// Sends a heartbeat, without waiting; fails if earlier ones were not acknowledged in time.
    fn beat(&mut self) -> Result<(), String>;

    /// Stops watching: the arm is at rest.
    fn rest(&mut self);

    /// Has the arm stopped over another connection than this program's, and waits until that is acknowledged; fails if
    /// it is not.
    fn stop(&mut self) -> Result<(), String>;
}

/// Watches nothing: for arms that this program simulates, which end with it.
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

    fn stop(&mut self) -> Result<(), String> {
        Err("this arm has no watchdog".to_owned())
    }
}
