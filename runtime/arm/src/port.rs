//! The message interface between a driver and the node that moves an arm.
//!
//! In: goals, cancellations, stops. Out: the state of each goal, and the arm's last readings. A port only sends and
//! receives: the driver decides what a lost message or an aborted goal means.

mod stamps;
mod track;

pub use stamps::Stamps;
pub use track::Track;

use nalgebra::{Isometry3, Vector3};

/// A point of a joint trajectory, with how it is passed; each list goes from the base to the hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Waypoint {
    /// Angles, radians.
    pub joints_rad: Vec<f64>,
    /// Speeds, rad/s.
    pub speeds_rad_s: Vec<f64>,
    /// Accelerations, rad/s².
    pub accelerations_rad_s2: Vec<f64>,
    /// Time since the start of the trajectory, seconds; strictly increasing.
    pub at_s: f64,
}

impl Waypoint {
    /// Makes a point at which the joints rest.
    pub fn at_rest(joints_rad: Vec<f64>, at_s: f64) -> Waypoint {
        let still = vec![0.0; joints_rad.len()];
        Waypoint {
            joints_rad,
            speeds_rad_s: still.clone(),
            accelerations_rad_s2: still,
            at_s,
        }
    }

    /// Returns the time since the start as whole seconds and the nanoseconds that are left, below 1,000,000,000.
    pub fn time_from_start(&self) -> (i32, u32) {
        // Rounded as a whole, so that the nanoseconds never reach a full second.
        let nanoseconds = (self.at_s * 1e9).round() as i64;
        (
            (nanoseconds / 1_000_000_000) as i32,
            (nanoseconds % 1_000_000_000) as u32,
        )
    }
}

/// Identifies a goal that was sent.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GoalId(pub String);

/// The state of a goal, as far as the server reported it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GoalState {
    /// It was sent, and the server has not acknowledged it.
    Sent,
    /// The server accepted it and is executing it.
    Active,
    /// It is over.
    Ended(Ending),
}

/// The terminal status of a goal, as in actionlib.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The server reports that it was reached.
    Succeeded,
    /// It was cancelled, preempted by another goal, or given up by the arm's node as stalled.
    Preempted,
    /// The server aborted it.
    Aborted,
    /// The server did not accept it.
    Rejected,
}

/// A value that an arm published, and when it was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<T> {
    /// The value.
    pub value: T,
    /// When it was taken, on the port's clock, seconds: by its stamp ([`Stamps`]), or its receipt if it has none.
    pub at_s: f64,
}

/// The last readings of an arm; `None` if nothing was received yet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readings {
    /// Pose of the tool, `base_from_tool`.
    pub tool: Option<Reading<Isometry3<f64>>>,
    /// Angles of the joints from the base to the hand, radians.
    pub joints_rad: Option<Reading<Vec<f64>>>,
    /// Positions of the fingers, in the node's own units.
    pub fingers: Option<Reading<Vec<f64>>>,
}

/// Why a message could not be sent, or a service did not answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}: {why}")]
pub struct PortError {
    /// What was tried, e.g. ``the service `in/stop` ``.
    pub what: String,
    /// What went wrong.
    pub why: String,
}

/// A connection to the node that moves an arm.
///
/// Sending only queues a message; `goal` reports whether a goal was accepted, and how it ended. Only `stop` and
/// `start` wait for an answer.
pub trait Port {
    /// Returns the time of a monotonic clock, seconds.
    fn now_s(&self) -> f64;

    /// Waits while messages arrive.
    fn wait(&mut self, seconds: f64);

    /// Moves the joints through these points, which preempts the trajectory before (`FollowJointTrajectory`).
    fn send_trajectory(&mut self, points: &[Waypoint]) -> Result<GoalId, PortError>;

    /// Moves the tool to a pose, `base_from_tool`.
    fn send_pose(&mut self, _tool: &Isometry3<f64>) -> Result<GoalId, PortError> {
        Err(PortError {
            what: "a pose of the tool".to_owned(),
            why: "this arm takes joint trajectories only".to_owned(),
        })
    }

    /// Moves the fingers to these positions, in the arm's own units, one each.
    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError>;

    /// Returns the state of a goal.
    fn goal(&mut self, goal: &GoalId) -> GoalState;

    /// Requests the cancellation of a goal; its state shows whether it was cancelled. The arm stays enabled.
    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError>;

    /// Stops the arm; fails if nothing acknowledges the stop.
    fn stop(&mut self) -> Result<(), PortError>;

    /// Sends a goal that moves nothing, and that a stopped arm refuses, which reveals a stop. `None` if the arm takes goals
    /// after a stop, which then only ended the motion.
    fn probe(&mut self) -> Result<Option<GoalId>, PortError> {
        Ok(None)
    }

    /// Returns until when the tool moved if it came to rest at a place, or at that of its last reading, on this clock,
    /// seconds; `None` without steady motion. Readings since the last goal count, until that is cancelled.
    ///
    /// For an arm whose node enables it when a goal is cancelled, whoever stopped it before. Others keep their stop.
    fn moved_until_s(&mut self, _rest: Option<&Vector3<f64>>) -> Option<f64> {
        Some(f64::INFINITY)
    }

    /// Enables a stopped arm. Called only at a person's request.
    fn start(&mut self) -> Result<(), PortError>;

    /// Returns the arm's state, which is its last readings.
    fn state(&mut self) -> Readings;
}
