//! The message interface between a driver and the node that moves an arm.
//!
//! In: goals, cancellations, stops. Out: the state of each goal, and the arm's last readings. A port only sends and
//! receives: the driver decides what a lost message or an aborted goal means.

use nalgebra::Isometry3;

/// A goal for an action server of the arm's node.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// Move the tool to a pose (`pose_action/tool_pose`), `base_from_tool`.
    ToolPose(Isometry3<f64>),
    /// Move the joints to these angles (`joints_action/joint_angles`), radians, from the base to the hand.
    JointAngles(Vec<f64>),
    /// Move the fingers to these positions (`fingers_action/finger_positions`), in the node's own units, one each.
    Fingers(Vec<f64>),
    /// Move the joints through these points (`FollowJointTrajectory`).
    Trajectory(Vec<Waypoint>),
}

/// A point of a joint trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct Waypoint {
    /// Angles from the base to the hand, radians.
    pub joints_rad: Vec<f64>,
    /// Time since the start of the trajectory, seconds; strictly increasing.
    pub at_s: f64,
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

/// A value that an arm published, and when it was received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<T> {
    /// The value.
    pub value: T,
    /// Time of receipt on the port's clock, seconds.
    pub at_s: f64,
}

/// The last readings of an arm; `None` if nothing was received yet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readings {
    /// Pose of the tool (`out/tool_pose`), `base_from_tool`.
    pub tool: Option<Reading<Isometry3<f64>>>,
    /// Angles of the joints from the base to the hand (`out/joint_state`), radians.
    pub joints_rad: Option<Reading<Vec<f64>>>,
    /// Positions of the fingers (`out/finger_position`), in the node's own units.
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
/// Only `stop` and `start` wait for an answer.
pub trait Port {
    /// Returns the time of a monotonic clock, seconds.
    fn now_s(&self) -> f64;

    /// Waits while messages arrive.
    fn wait(&mut self, seconds: f64);

    /// Sends a goal, which preempts an active goal of the same server.
    fn send(&mut self, goal: &Goal) -> Result<GoalId, PortError>;

    /// Returns the state of a goal.
    fn state(&mut self, goal: &GoalId) -> GoalState;

    /// Requests the cancellation of a goal. The arm's node ends the motion and stays enabled.
    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError>;

    /// Stops the arm, which then refuses motion until `start` (`in/stop`). Without that service every goal is
    /// cancelled.
    fn stop(&mut self) -> Result<(), PortError>;

    /// Enables a stopped arm (`in/start`). Called only at a person's request.
    fn start(&mut self) -> Result<(), PortError>;

    /// Returns the last readings.
    fn readings(&mut self) -> Readings;
}
