//! Says a motion of the tool in the words of an arm's node.
//!
//! In: where the arm is, where its tool is to go and how fast. Out: the goal. By poses the node itself finds the joints, so
//! that nothing is known of the way of elbow and wrist; by trajectories every joint's place on the way is checked here.

use super::look::LOOK_S;
use super::{ArmError, ArmState, Off};
use crate::kinematics::chain::{Chain, JOINTS};
use crate::port::{Goal, Waypoint};
use nalgebra::Isometry3;

/// The longest step between two points of a trajectory, metres.
const STEP_M: f64 = 0.01;

/// How motions are said to an arm's node.
pub(super) enum Way {
    /// As poses of the tool; the node finds the joints.
    Poses,
    /// As trajectories of the joints.
    Trajectories(Box<Trajectories>),
}

/// Trajectories that this crate's kinematics find.
pub(super) struct Trajectories {
    chain: Chain,
    /// Height below which no joint may come, metres, base frame; minus infinity where none was stated.
    pub(super) floor_m: f64,
}

impl Way {
    pub(super) fn by_trajectories(chain: Chain) -> Way {
        Way::Trajectories(Box::new(Trajectories {
            chain,
            floor_m: f64::NEG_INFINITY,
        }))
    }

    /// Returns the goal that brings the tool to a pose.
    pub(super) fn goal(
        &self,
        from: &ArmState,
        to: &Isometry3<f64>,
        speed_m_s: f64,
    ) -> Result<Goal, ArmError> {
        match self {
            Way::Poses => Ok(Goal::ToolPose(*to)),
            Way::Trajectories(trajectories) => trajectories.goal(from, to, speed_m_s),
        }
    }
}

impl Trajectories {
    fn goal(&self, from: &ArmState, to: &Isometry3<f64>, speed_m_s: f64) -> Result<Goal, ArmError> {
        let off = Off::between(&from.tool, to);
        if off.position_m < 1e-6 && off.angle_rad < 1e-6 {
            return Ok(hold(&from.joints_rad));
        }
        let points = self
            .chain
            .straight(&from.tool, to, &from.joints_rad, STEP_M)
            .map_err(|why| ArmError::NoWay(why.to_string()))?;
        let step_s = off.position_m / speed_m_s / (points.len().max(2) - 1) as f64;
        let mut at_s = 0.0;
        let mut before = from.joints_rad.clone();
        let mut waypoints = Vec::with_capacity(points.len());
        for joints_rad in points {
            self.stays_above(&joints_rad)?;
            // No joint is faster than it can be, whatever the tool's speed.
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

    /// Checks that every joint is above the table; between two joints an arm is straight, and so is its way to the tool.
    fn stays_above(&self, joints_rad: &[f64]) -> Result<(), ArmError> {
        let frames = self.chain.frames(joints_rad);
        let frames = frames.map_err(|why| ArmError::NoWay(why.to_string()))?;
        for (index, frame) in frames.iter().take(JOINTS).enumerate() {
            let below_m = self.floor_m - frame.translation.z;
            if below_m > 0.0 {
                return Err(ArmError::NoWay(format!(
                    "joint `{}` would be {:.0} mm below the table on the way; bring the arm to a posture with its elbow up",
                    index + 1,
                    below_m * 1000.0
                )));
            }
        }
        Ok(())
    }
}

/// Returns the trajectory that keeps the joints where they are, in two points, as kinova-ros's controller needs it.
pub(super) fn hold(joints_rad: &[f64]) -> Goal {
    let at = |at_s| Waypoint {
        joints_rad: joints_rad.to_vec(),
        at_s,
    };
    Goal::Trajectory(vec![at(LOOK_S), at(2.0 * LOOK_S)])
}

/// Returns how long a goal lasts by its own word, seconds; none where it says nothing of time.
pub(super) fn lasts_s(goal: &Goal) -> Option<f64> {
    match goal {
        Goal::Trajectory(points) => points.last().map(|last| last.at_s),
        Goal::ToolPose(_) | Goal::JointAngles(_) | Goal::Fingers(_) => None,
    }
}
