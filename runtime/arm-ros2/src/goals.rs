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
    if points.len() < 2 {
        return Err(format!(
            "it has {} points, and needs at least 2",
            points.len()
        ));
    }
    let mut before_s = -1.0;
    for (index, point) in points.iter().enumerate() {
        let (found, expected) = (point.joints_rad.len(), joints.len());
        if found != expected {
            return Err(format!(
                "it names {found} joints, and the arm has {expected}"
            ));
        }
        let rates = point.speeds_rad_s.iter().chain(&point.accelerations_rad_s2);
        check_finite(point.joints_rad.iter().chain(rates).chain([&point.at_s]))?;
        let is_later = if index == 0 {
            point.at_s >= 0.0
        } else {
            point.at_s > before_s
        };
        if !is_later || point.at_s > f64::from(i32::MAX) {
            return Err(format!(
                "point {index} is at `{}` s, not after the one before",
                point.at_s
            ));
        }
        before_s = point.at_s;
    }
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
    // Rounded as a whole, so that the nanoseconds never reach a full second.
    let nanoseconds = (point.at_s * 1e9).round() as i64;
    JointTrajectoryPoint {
        positions: point.joints_rad.clone(),
        velocities: point.speeds_rad_s.clone(),
        accelerations: point.accelerations_rad_s2.clone(),
        time_from_start: Duration {
            sec: (nanoseconds / 1_000_000_000) as i32,
            nanosec: (nanoseconds % 1_000_000_000) as u32,
        },
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

fn check_finite<'a>(values: impl IntoIterator<Item = &'a f64>) -> Result<(), String> {
    match values.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(format!("it holds `{value}`, which is not a number")),
        None => Ok(()),
    }
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
        let points = |points: &[Waypoint]| trajectory(points, &names()).err();
        let faults = [
            (
                points(&[waypoint(0.0, 1.0)]),
                "it has 1 points, and needs at least 2",
            ),
            (
                points(&[waypoint(0.0, f64::NAN), waypoint(1.0, 2.0)]),
                "it holds `NaN`, which is not a number",
            ),
            (
                points(&[waypoint(1.0, 1.0), waypoint(1.0, 2.0)]),
                "point 1 is at `1` s, not after the one before",
            ),
            (
                points(&[waypoint(0.0, 1.0), waypoint(1e12, 2.0)]),
                "point 1 is at `1000000000000` s, not after the one before",
            ),
            (
                trajectory(&[waypoint(0.0, 1.0), waypoint(1.0, 2.0)], &names()[..1]).err(),
                "it names 2 joints, and the arm has 1",
            ),
            (
                gripper(&[0.1, 0.2], 5.0).err(),
                "it has the positions `[0.1, 0.2]`, and a gripper's fingers move together",
            ),
            (
                parallel_gripper(&[f64::INFINITY; 2], &names(), 5.0).err(),
                "it holds `inf`, which is not a number",
            ),
            (
                gripper(&[], 5.0).err(),
                "it has the positions `[]`, and a gripper's fingers move together",
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
        let sent = trajectory(&points, &names()).unwrap().trajectory;
        assert_eq!(sent.joint_names, names());
        assert_eq!(sent.points[0].velocities, [0.0, 0.0]);
        assert_eq!(sent.points[1].velocities, [2.0, 0.5]);
        assert_eq!(sent.points[1].accelerations, [-3.0, 0.25]);
        assert_eq!(sent.points[2].velocities, [0.0, 0.0]);
        let times: Vec<_> = sent
            .points
            .iter()
            .map(|point| (point.time_from_start.sec, point.time_from_start.nanosec))
            .collect();
        assert_eq!(times, [(0, 0), (0, 500_000_000), (2, 0)]);
    }
}
