//! The actions of a controller and of a gripper, and the goal messages for them.
//!
//! In: goals in radians, seconds, and the gripper's own units. Out: messages.

use super::action::Action;
use super::messages::{
    Duration, FollowJointTrajectoryGoal, FollowJointTrajectoryResult, GripperCommand,
    GripperCommandGoal, GripperCommandResult, JointState, JointTrajectory, JointTrajectoryPoint,
    ParallelGripperCommandGoal, ParallelGripperCommandResult,
};
use fab_arm::port::Waypoint;

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
pub(crate) fn trajectory(points: &[Waypoint], joints: &[String]) -> FollowJointTrajectoryGoal {
    let messages = points.iter().map(point_message);
    FollowJointTrajectoryGoal {
        trajectory: JointTrajectory {
            joint_names: joints.to_vec(),
            points: messages.collect(),
            ..JointTrajectory::default()
        },
        ..FollowJointTrajectoryGoal::default()
    }
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

/// Makes the goal of a gripper at one position, in its own units.
pub(crate) fn gripper(position: f64, max_effort: f64) -> GripperCommandGoal {
    GripperCommandGoal {
        command: GripperCommand {
            position,
            max_effort,
        },
    }
}

/// Makes the goal of a gripper whose joints are named; they all go to one position.
pub(crate) fn parallel_gripper(
    position: f64,
    joints: &[String],
    max_effort: f64,
) -> ParallelGripperCommandGoal {
    // No effort means the controller's own.
    let efforts = joints
        .iter()
        .map(|_| max_effort)
        .filter(|effort| *effort > 0.0);
    ParallelGripperCommandGoal {
        command: JointState {
            name: joints.to_vec(),
            position: vec![position; joints.len()],
            effort: efforts.collect(),
            ..JointState::default()
        },
    }
}

#[cfg(test)]
#[path = "tests/goals.rs"]
mod tests;
