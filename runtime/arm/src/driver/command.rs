//! Turns a motion of the tool into a goal for the arm's node.
//!
//! In: a checked motion. Out: the goal. With tool poses the node solves the inverse kinematics, so the path of elbow
//! and wrist may be another than the one that was checked; a trajectory is what was checked.

use super::goal::Goal;
use super::state::POLL_S;
use super::{ArmError, ArmState};
use crate::guard::{Checked, Motion};

/// How far from the joints' angles a trajectory may begin, radians: it begins where they were when it was checked, and
/// the readings of an arm at rest differ by less.
const BEGIN_RAD: f64 = 0.01;

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
    pub(super) fn goal(self, from: &ArmState, motion: &Checked<Motion>) -> Result<Goal, ArmError> {
        match self {
            CommandMode::Poses => Ok(Goal::Pose(motion.pose())),
            CommandMode::Trajectories => trajectory(from, motion),
        }
    }
}

/// Returns the trajectory of a motion that begins where the joints are.
fn trajectory(from: &ArmState, motion: &Checked<Motion>) -> Result<Goal, ArmError> {
    let first = match motion.get().waypoints.as_slice() {
        [] => {
            let why = "the arm did not report its joints when this motion was checked";
            return Err(ArmError::Refused(why.to_owned()));
        }
        [_] => return Ok(hold_position(from)),
        [first, ..] => first,
    };
    let pairs = first.joints_rad.iter().zip(&from.joints_rad).enumerate();
    for (joint, (begins_at, is_at)) in pairs {
        // NaN must be refused.
        let fits = (begins_at - is_at).abs() < BEGIN_RAD;
        if !fits {
            return Err(ArmError::Refused(format!(
                "the arm reports joint {} at {:.1} degrees, and its tool where that joint would be at {:.1}: the \
                 readings do not fit, or `model` names another arm",
                joint + 1,
                is_at.to_degrees(),
                begins_at.to_degrees()
            )));
        }
    }
    Ok(Goal::Trajectory(motion.trajectory()))
}

/// Returns a trajectory that holds the joints where they are. It has two points because kinova-ros's controller needs
/// two.
pub(super) fn hold_position(state: &ArmState) -> Goal {
    Goal::Trajectory(Checked::hold(state, &[POLL_S, 2.0 * POLL_S]))
}
