//! The action servers of an arm's node, and the goal messages for them.
//!
//! In: goals in metres and radians. Out: messages in the units of kinova-ros: metres and unit quaternions, finger
//! units; radians for trajectories. A goal that no message can represent is refused here, with a reason.

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
use fab_arm::port::goals::{check_count, check_finite, check_trajectory};
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
) -> Result<impl FnOnce(GoalID) -> ArmPoseActionGoal, String> {
    let (at, turn) = (pose.translation.vector, pose.rotation.coords);
    check_finite(at.iter().chain(turn.iter()))?;
    let frame = frame.to_owned();
    Ok(move |id| {
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
    })
}

/// Makes the goal of `n_fingers` finger positions, in the node's units.
pub(super) fn fingers(
    positions: &[f64],
    n_fingers: usize,
) -> Result<impl FnOnce(GoalID) -> SetFingersPositionActionGoal + use<>, String> {
    let [finger1, finger2, finger3] = padded(positions, n_fingers, "fingers")?;
    Ok(move |id| {
        let mut message = SetFingersPositionActionGoal {
            goal_id: id,
            ..Default::default()
        };
        let fingers = &mut message.goal.fingers;
        (fingers.finger1, fingers.finger2, fingers.finger3) = (finger1, finger2, finger3);
        message
    })
}

/// Makes the goal of a trajectory through `points`, which starts on arrival.
///
/// kinova-ros's controller reads the velocities of every point and of the last but one without checking that they
/// exist, so a trajectory has at least two points, each with velocities.
pub(super) fn trajectory(
    points: &[Waypoint],
    joints: &[String],
) -> Result<impl FnOnce(GoalID) -> FollowJointTrajectoryActionGoal + use<>, String> {
    check_trajectory(points, joints.len())?;
    let messages: Vec<_> = points.iter().map(point_message).collect();
    let joints = joints.to_vec();
    Ok(move |id| {
        let mut message = FollowJointTrajectoryActionGoal {
            goal_id: id,
            ..Default::default()
        };
        message.goal.trajectory.joint_names = joints;
        message.goal.trajectory.points = messages;
        message
    })
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

/// Returns `n_values` values as the node's numbers, the rest 0.
fn padded<const N: usize>(values: &[f64], n_values: usize, what: &str) -> Result<[f32; N], String> {
    check_count(values.len(), n_values.min(N), what)?;
    let mut numbers = [0.0; N];
    for (number, value) in numbers.iter_mut().zip(values) {
        *number = *value as f32;
    }
    check_finite(numbers.map(f64::from).iter())?;
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn waypoint(at_s: f64, angle: f64) -> Waypoint {
        Waypoint::at_rest(vec![angle, 0.0], at_s)
    }

    fn names() -> Vec<String> {
        vec!["a".to_owned(), "b".to_owned()]
    }

    #[test]
    fn what_a_message_cannot_carry_is_refused_in_words() {
        let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
        let faults = [
            (
                tool_pose(&nowhere, "f").err(),
                "it holds `NaN`, which is not a number",
            ),
            (
                fingers(&[1e300; 2], 2).err(),
                "it holds `inf`, which is not a number",
            ),
            (
                fingers(&[0.0; 3], 2).err(),
                "it names 3 fingers, and the arm has 2",
            ),
        ];
        for (found, expected) in faults {
            assert_eq!(found.as_deref(), Some(expected));
        }
    }

    #[test]
    fn a_trajectory_says_how_fast_each_point_is_passed() {
        let mut points = [
            waypoint(0.0, 0.0),
            waypoint(0.5, 1.0),
            waypoint(1.9999999999, 4.0),
        ];
        points[1].speeds_rad_s = vec![2.0, 0.5];
        points[1].accelerations_rad_s2 = vec![-3.0, 0.25];
        let message = trajectory(&points, &names()).unwrap()(GoalID::default());
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
