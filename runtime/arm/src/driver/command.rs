//! Turns a motion of the tool into a goal for the arm's node.
//!
//! In: a checked motion. Out: the goal. With tool poses the node solves the inverse kinematics, so the path of elbow
//! and wrist may be another than the one that was checked; a trajectory is checked again with its times.

use super::goal::Goal;
use super::state::POLL_S;
use super::{ArmError, ArmState, Deviation};
use crate::guard::{Checked, Guard, Motion};
use crate::port::Waypoint;

/// Which kind of goal commands a motion of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CommandMode {
    /// Tool poses; the node solves the inverse kinematics.
    Poses,
    /// Joint trajectories, planned here.
    Trajectories,
}

impl CommandMode {
    /// Returns the goal of a motion from the arm's state.
    pub(super) fn goal(
        self,
        guard: &Guard,
        from: &ArmState,
        motion: &Checked<Motion>,
    ) -> Result<Goal, ArmError> {
        match self {
            CommandMode::Poses => Ok(Goal::Pose(motion.pose())),
            CommandMode::Trajectories => trajectory(guard, from, motion.get()),
        }
    }
}

/// Times the joint angles of a motion.
fn trajectory(guard: &Guard, from: &ArmState, motion: &Motion) -> Result<Goal, ArmError> {
    let deviation = Deviation::between(&from.tool, &motion.to);
    if deviation.position_m < 1e-6 && deviation.angle_rad < 1e-6 {
        return Ok(hold_position(from));
    }
    let points = &motion.joints_rad;
    let step_s = deviation.position_m / motion.speed_m_s / (points.len().max(2) - 1) as f64;
    let mut at_s = 0.0;
    let mut before = &from.joints_rad;
    let mut waypoints = Vec::with_capacity(points.len());
    for joints_rad in points {
        // Joint speed limits take precedence over the tool's speed.
        let turns = joints_rad.iter().zip(before).zip(guard.chain().joints());
        let slowest_s = turns
            .map(|((a, b), joint)| (a - b).abs() / joint.max_speed_rad_s)
            .fold(0.0, f64::max);
        at_s += step_s.max(slowest_s).max(1e-3);
        before = joints_rad;
        waypoints.push(Waypoint {
            joints_rad: joints_rad.clone(),
            at_s,
        });
    }
    let checked = guard.trajectory(waypoints).map_err(ArmError::Refused)?;
    Ok(Goal::Trajectory(checked))
}

/// Returns a trajectory that holds the joints where they are. It has two points because kinova-ros's controller needs
/// two.
pub(super) fn hold_position(state: &ArmState) -> Goal {
    Goal::Trajectory(Checked::hold(state, &[POLL_S, 2.0 * POLL_S]))
}

/// Returns the planned duration of a goal, seconds; `None` for goals without timing.
pub(super) fn duration_s(goal: &Goal) -> Option<f64> {
    match goal {
        Goal::Trajectory(points) => points.get().last().map(|last| last.at_s),
        Goal::Pose(_) | Goal::Fingers(_) => None,
    }
}
