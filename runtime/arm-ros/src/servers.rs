//! The action servers of an arm's node, and the goal messages for them.
//!
//! In: goals in metres and radians. Out: messages in the units of kinova-ros: metres and unit quaternions, finger
//! units; radians for trajectories.

use super::action::Action;
use super::messages::actionlib_msgs::{GoalID, GoalStatus};
use super::messages::control_msgs::{
    FollowJointTrajectoryActionGoal, FollowJointTrajectoryActionResult,
};
use super::messages::kinova_msgs::{
    ArmPoseActionGoal, ArmPoseActionResult, SetFingersPositionActionGoal,
    SetFingersPositionActionResult,
};
use super::messages::trajectory_msgs::JointTrajectoryPoint;
use fab_arm::port::Waypoint;
use nalgebra::Isometry3;
use roslibrust::codegen::integral_types::Duration;

/// Declares an action by its two messages.
macro_rules! action {
    ($(#[$doc:meta])* $name:ident, $goal:ty, $result:ty) => {
        $(#[$doc])*
        pub(super) struct $name;

        impl Action for $name {
            type Goal = $goal;
            type Result = $result;

            fn status(result: &$result) -> &GoalStatus {
                &result.status
            }
        }
    };
}

action!(
    /// `pose_action/tool_pose`.
    ToolPose,
    ArmPoseActionGoal,
    ArmPoseActionResult
);
action!(
    /// `fingers_action/finger_positions`.
    Fingers,
    SetFingersPositionActionGoal,
    SetFingersPositionActionResult
);
action!(
    /// `FollowJointTrajectory`.
    Trajectory,
    FollowJointTrajectoryActionGoal,
    FollowJointTrajectoryActionResult
);

/// Makes the goal of a tool pose, `base_from_tool`, in `frame`.
pub(super) fn tool_pose(
    pose: &Isometry3<f64>,
    frame: &str,
) -> impl FnOnce(GoalID) -> ArmPoseActionGoal {
    let (at, turn) = (pose.translation.vector, pose.rotation.coords);
    let frame = frame.to_owned();
    move |id| {
        let mut message = ArmPoseActionGoal {
            goal_id: id,
            ..Default::default()
        };
        let goal = &mut message.goal.pose;
        goal.header.frame_id = frame;
        let (position, orientation) = (&mut goal.pose.position, &mut goal.pose.orientation);
        (position.x, position.y, position.z) = (at.x, at.y, at.z);
        (orientation.x, orientation.y, orientation.z, orientation.w) =
            (turn.x, turn.y, turn.z, turn.w);
        message
    }
}

/// Makes the goal of finger positions, in the node's units; the node has three places, whatever the hand.
pub(super) fn fingers(
    positions: &[f64],
) -> impl FnOnce(GoalID) -> SetFingersPositionActionGoal + use<> {
    let [finger1, finger2, finger3] =
        [0, 1, 2].map(|finger| positions.get(finger).copied().unwrap_or_default() as f32);
    move |id| {
        let mut message = SetFingersPositionActionGoal {
            goal_id: id,
            ..Default::default()
        };
        let fingers = &mut message.goal.fingers;
        (fingers.finger1, fingers.finger2, fingers.finger3) = (finger1, finger2, finger3);
        message
    }
}

/// Makes the goal of a trajectory through `points`, which starts on arrival.
///
/// kinova-ros's controller reads the velocities of every point and of the last but one without checking that they
/// exist; every checked trajectory has two points at least, each with velocities.
pub(super) fn trajectory(
    points: &[Waypoint],
    joints: &[String],
) -> impl FnOnce(GoalID) -> FollowJointTrajectoryActionGoal + use<> {
    let messages: Vec<_> = points.iter().map(point_message).collect();
    let joints = joints.to_vec();
    move |id| {
        let mut message = FollowJointTrajectoryActionGoal {
            goal_id: id,
            ..Default::default()
        };
        message.goal.trajectory.joint_names = joints;
        message.goal.trajectory.points = messages;
        message
    }
}

fn point_message(point: &Waypoint) -> JointTrajectoryPoint {
    let (sec, nanoseconds) = point.time_from_start();
    JointTrajectoryPoint {
        positions: point.joints_rad.clone(),
        velocities: point.speeds_rad_s.clone(),
        accelerations: point.accelerations_rad_s2.clone(),
        time_from_start: Duration {
            sec,
            nsec: nanoseconds as i32,
        },
        ..Default::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trajectory_says_how_fast_each_point_is_passed() {
        let at = |at_s, angle| Waypoint::at_rest(vec![angle, 0.0], at_s);
        let mut points = [at(0.0, 0.0), at(0.5, 1.0), at(1.9999999999, 4.0)];
        points[1].speeds_rad_s = vec![2.0, 0.5];
        points[1].accelerations_rad_s2 = vec![-3.0, 0.25];
        let names = ["a", "b"].map(str::to_owned);
        let message = trajectory(&points, &names)(GoalID::default());
        let sent = message.goal.trajectory.points;
        assert_eq!(sent[0].velocities, [0.0, 0.0]);
        assert_eq!(sent[1].velocities, [2.0, 0.5]);
        assert_eq!(sent[1].accelerations, [-3.0, 0.25]);
        assert_eq!(sent[2].velocities, [0.0, 0.0]);
        let times: Vec<_> = sent
            .iter()
            .map(|point| (point.time_from_start.sec, point.time_from_start.nsec))
            .collect();
        assert_eq!(times, [(0, 0), (0, 500_000_000), (2, 0)]);
    }
}
