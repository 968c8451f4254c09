//! The actions of a controller and of a gripper, and the goal messages for them.
//!
//! In: goals in radians, seconds, and the gripper's own units. Out: messages. A goal that no message can represent is
//! refused here, with a reason.

use super::action::Action;
use super::messages::{
    Duration, FollowJointTrajectoryGoal, FollowJointTrajectoryResult, GripperCommand,
    GripperCommandGoal, GripperCommandResult, JointState, JointTrajectory, JointTrajectoryPoint,
    ParallelGripperCommandGoal, ParallelGripperCommandResult,
};
use fab_arm::port::Waypoint;
use fab_arm::port::goals::{check_finite, check_trajectory};

/// Declares an action of `control_msgs`.
macro_rules! action {
    ($(#[$doc:meta])* $name:ident, $dds:literal, $goal:ty, $result:ty) => {
        $(#[$doc])*
        pub(crate) struct $name;

        impl Action for $name {
            const TYPES: [&'static str; 2] = [
                concat!("control_msgs::action::dds_::", $dds, "_SendGoal"),
                concat!("control_msgs::action::dds_::", $dds, "_GetResult"),
            ];
            type Goal = $goal;
            type Result = $result;
        }
    };
}

action!(
    /// A trajectory of joints.
    Trajectory,
    "FollowJointTrajectory",
    FollowJointTrajectoryGoal,
    FollowJointTrajectoryResult
);
action!(
    /// One position of a gripper.
    Gripper,
    "GripperCommand",
    GripperCommandGoal,
    GripperCommandResult
);
action!(
    /// Positions of a gripper's joints.
    ParallelGripper,
    "ParallelGripperCommand",
    ParallelGripperCommandGoal,
    ParallelGripperCommandResult
);

/// Makes the goal of a trajectory through `points`, which starts on arrival.
///
/// Each point has speeds and accelerations, so that the controller interpolates as the motion was planned.
pub(crate) fn trajectory(
    points: &[Waypoint],
    joints: &[String],
) -> Result<FollowJointTrajectoryGoal, String> {
    check_trajectory(points, joints.len())?;
    let messages = points.iter().map(point_message);
    Ok(FollowJointTrajectoryGoal {
        trajectory: JointTrajectory {
            joint_names: joints.to_vec(),
            points: messages.collect(),
            ..JointTrajectory::default()
        },
        ..FollowJointTrajectoryGoal::default()
    })
}

fn point_message(point: &Waypoint) -> JointTrajectoryPoint {
    let (sec, nanosec) = point.time_from_start();
    JointTrajectoryPoint {
        positions: point.joints_rad.clone(),
        velocities: point.speeds_rad_s.clone(),
        accelerations: point.accelerations_rad_s2.clone(),
        time_from_start: Duration { sec, nanosec },
        ..JointTrajectoryPoint::default()
    }
}

/// Makes the goal of a gripper at one position, in its own units; the fingers move together.
pub(crate) fn gripper(positions: &[f64], max_effort: f64) -> Result<GripperCommandGoal, String> {
    Ok(GripperCommandGoal {
        command: GripperCommand {
            position: together(positions)?,
            max_effort,
        },
    })
}

/// Makes the goal of a gripper whose joints are named.
pub(crate) fn parallel_gripper(
    positions: &[f64],
    joints: &[String],
    max_effort: f64,
) -> Result<ParallelGripperCommandGoal, String> {
    let position = together(positions)?;
    Ok(ParallelGripperCommandGoal {
        command: JointState {
            name: joints.to_vec(),
            position: vec![position; joints.len()],
            // No effort means the controller's own.
            effort: match max_effort > 0.0 {
                true => vec![max_effort; joints.len()],
                false => Vec::new(),
            },
            ..JointState::default()
        },
    })
}

fn together(positions: &[f64]) -> Result<f64, String> {
    check_finite(positions)?;
    match positions {
        [first, rest @ ..] if rest.iter().all(|position| position == first) => Ok(*first),
        other => Err(format!(
            "it has the positions `{other:?}`, and a gripper's fingers move together"
        )),
    }
}

#[cfg(test)]
#[path = "tests/goals.rs"]
mod tests;
