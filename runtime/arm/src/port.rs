//! The messages between a driver of ours and the node that moves an arm.
//!
//! In: goals, cancellations, stops. Out: what became of them, and what the arm last said of itself. A port sends and
//! receives and decides nothing: what a lost message or an aborted goal means is for the driver to say.

use nalgebra::Isometry3;

/// What an action server of the arm's node is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// Bring the tool to a pose (`pose_action/tool_pose`), `base_from_tool`.
    ToolPose(Isometry3<f64>),
    /// Bring the joints to these angles (`joints_action/joint_angles`), radians, from the base to the hand.
    JointAngles(Vec<f64>),
    /// Bring the fingers to these positions (`fingers_action/finger_positions`), in the node's own units, one each.
    Fingers(Vec<f64>),
    /// Bring the joints through these points (`FollowJointTrajectory`).
    Trajectory(Vec<Waypoint>),
}

/// A point that the joints pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Waypoint {
    /// Angles from the base to the hand, radians.
    pub joints_rad: Vec<f64>,
    /// When, seconds after the beginning of the trajectory; grows from point to point.
    pub at_s: f64,
}

/// Names a goal that was sent.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GoalId(pub String);

/// What is known of a goal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GoalState {
    /// It was sent, and nothing was heard of it since.
    Sent,
    /// The server took it and works on it.
    Active,
    /// It is over.
    Ended(Ending),
}

/// How a goal ended, in the words of actionlib.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The server says that it was reached.
    Succeeded,
    /// It was cancelled, or gave way to another, or the arm's node gave it up as stalled.
    Preempted,
    /// The server gave it up.
    Aborted,
    /// The server did not take it.
    Rejected,
}

/// Something that an arm said, and when it was heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heard<T> {
    /// What it said.
    pub value: T,
    /// When, on the port's clock, seconds.
    pub at_s: f64,
}

/// What the arm last said of itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Readings {
    /// Pose of the tool (`out/tool_pose`), `base_from_tool`.
    pub tool: Option<Heard<Isometry3<f64>>>,
    /// Angles of the joints from the base to the hand (`out/joint_state`), radians.
    pub joints_rad: Option<Heard<Vec<f64>>>,
    /// Positions of the fingers (`out/finger_position`), in the node's own units.
    pub fingers: Option<Heard<Vec<f64>>>,
}

/// Why a message could not be sent or a service gave no answer.
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
/// Nothing but `stop` and `start` waits for an answer. Passed by every implementation: `tests/suite/port_conformance.rs`.
pub trait Port {
    /// Returns the time of a clock that never goes back, seconds.
    fn now_s(&self) -> f64;

    /// Lets time pass, while messages arrive.
    fn wait(&mut self, seconds: f64);

    /// Sends a goal; a goal of the same server that is under way gives way to it.
    fn send(&mut self, goal: &Goal) -> Result<GoalId, PortError>;

    /// Returns what is known of a goal.
    fn state(&mut self, goal: &GoalId) -> GoalState;

    /// Asks to give a goal up. The arm's node ends the motion and stays enabled.
    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError>;

    /// Stops the arm, which then takes no motion until `start` (`in/stop`); where a node has no such service, every goal is cancelled.
    fn stop(&mut self) -> Result<(), PortError>;

    /// Lets a stopped arm move again (`in/start`). Called only where a person asked for it.
    fn start(&mut self) -> Result<(), PortError>;

    /// Returns what the arm last said of itself.
    fn readings(&mut self) -> Readings;
}
