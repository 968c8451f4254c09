//! Turns a motion of the tool into a goal for the arm's node.
//!
//! In: the arm's state, the target pose, the speed. Out: the goal. With tool poses the node solves the inverse
//! kinematics, so the path of elbow and wrist is unknown; with trajectories every joint position on the path is checked
//! here.

use super::goal::Goal;
use super::state::POLL_S;
use super::{ArmError, ArmState, Deviation};
use crate::kinematics::chain::{Chain, JOINTS};
use crate::port::Waypoint;
use nalgebra::Isometry3;

/// The longest step between two points of a trajectory, metres.
const STEP_M: f64 = 0.01;

/// Which kind of goal commands a motion of the tool.
pub(super) enum CommandMode {
    /// Tool poses; the node solves the inverse kinematics.
    Poses,
    /// Joint trajectories, planned here.
    Trajectories(Box<TrajectoryPlanner>),
}

/// Plans joint trajectories with this crate's kinematics.
pub(super) struct TrajectoryPlanner {
    chain: Chain,
    /// Height that no joint may go below, metres, base frame; minus infinity for no limit.
    pub(super) floor_m: f64,
}

impl CommandMode {
    pub(super) fn by_trajectories(chain: Chain) -> CommandMode {
        CommandMode::Trajectories(Box::new(TrajectoryPlanner {
            chain,
            floor_m: f64::NEG_INFINITY,
        }))
    }

    /// Returns the goal that moves the tool to a pose.
    pub(super) fn goal(
        &self,
        from: &ArmState,
        to: &Isometry3<f64>,
        speed_m_s: f64,
    ) -> Result<Goal, ArmError> {
        match self {
            CommandMode::Poses => Ok(Goal::Pose(*to)),
            CommandMode::Trajectories(trajectories) => trajectories.goal(from, to, speed_m_s),
        }
    }
}

impl TrajectoryPlanner {
    fn goal(&self, from: &ArmState, to: &Isometry3<f64>, speed_m_s: f64) -> Result<Goal, ArmError> {
        let deviation = Deviation::between(&from.tool, to);
        if deviation.position_m < 1e-6 && deviation.angle_rad < 1e-6 {
            return Ok(hold_position(&from.joints_rad));
        }
        let points = self
            .chain
            .straight(&from.tool, to, &from.joints_rad, STEP_M)
            .map_err(|why| ArmError::NoPath(why.to_string()))?;
        let step_s = deviation.position_m / speed_m_s / (points.len().max(2) - 1) as f64;
        let mut at_s = 0.0;
        let mut before = from.joints_rad.clone();
        let mut waypoints = Vec::with_capacity(points.len());
        for joints_rad in points {
            self.check_above_floor(&joints_rad)?;
            // Joint speed limits take precedence over the tool's speed.
            let turns = joints_rad.iter().zip(&before).zip(self.chain.joints());
            let slowest_s = turns
                .map(|((a, b), joint)| (a - b).abs() / joint.max_speed_rad_s)
                .fold(0.0, f64::max);
            at_s += step_s.max(slowest_s).max(1e-3);
            before = joints_rad.clone();
            waypoints.push(Waypoint { joints_rad, at_s });
        }
        Ok(Goal::Trajectory(waypoints))
    }

    /// Checks that every joint is above the floor. Links are straight, so the joints bound them from below.
    fn check_above_floor(&self, joints_rad: &[f64]) -> Result<(), ArmError> {
        let frames = self.chain.frames(joints_rad);
        let frames = frames.map_err(|why| ArmError::NoPath(why.to_string()))?;
        for (index, frame) in frames.iter().take(JOINTS).enumerate() {
            let below_m = self.floor_m - frame.translation.z;
            if below_m > 0.0 {
                return Err(ArmError::NoPath(format!(
                    "joint `{}` would be {:.0} mm below the table on the way; bring the arm to a posture with its elbow up",
                    index + 1,
                    below_m * 1000.0
                )));
            }
        }
        Ok(())
    }
}

/// Returns a trajectory that holds the joints where they are. It has two points because kinova-ros's controller needs
/// two.
pub(super) fn hold_position(joints_rad: &[f64]) -> Goal {
    let at = |at_s| Waypoint {
        joints_rad: joints_rad.to_vec(),
        at_s,
    };
    Goal::Trajectory(vec![at(POLL_S), at(2.0 * POLL_S)])
}

/// Returns the planned duration of a goal, seconds; `None` for goals without timing.
pub(super) fn duration_s(goal: &Goal) -> Option<f64> {
    match goal {
        Goal::Trajectory(points) => points.last().map(|last| last.at_s),
        Goal::Pose(_) | Goal::Fingers(_) => None,
    }
}
