//! An arm over ROS: its reported position, and goals that it reaches or gives up.

use super::nodes::{Ros, TRAJECTORY, outcome, until_active};
use fab_arm::port::{Ending, GoalId, GoalState, Port, Waypoint};
use fab_arm::settings::RosSettings;
use fab_arm_ros::RosPort;
use nalgebra::{Isometry3, Translation3};

/// A pose `by_m` metres above the tool's current position.
fn above(port: &mut RosPort, by_m: f64) -> Isometry3<f64> {
    let tool = port.state().tool.unwrap().value;
    Translation3::new(0.0, 0.0, by_m) * tool
}

fn distance(left: &Isometry3<f64>, right: &Isometry3<f64>) -> f64 {
    (left.translation.vector - right.translation.vector).norm()
        + left.rotation.angle_to(&right.rotation)
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_an_arm_says_where_it_is() {
    let ros = Ros::with_arm();
    let mut port = ros.connect();
    let first = port.state();
    let tool = first.tool.unwrap();
    let hand = tool.value.rotation * nalgebra::Vector3::z();
    assert!(
        (tool.value.translation.vector - nalgebra::Vector3::new(0.3, -0.2, 0.4)).norm() < 1e-12
    );
    assert!(
        (hand + nalgebra::Vector3::z()).norm() < 1e-9,
        "the hand points down"
    );
    assert_eq!(
        first.joints_rad.unwrap().value,
        [4.8, 2.9, 1.0, 4.2, 1.4, 1.3]
    );
    assert_eq!(first.fingers.unwrap().value, [0.0, 0.0]);
    port.wait(0.5);
    let later = port.state().tool.unwrap().at_s;
    assert!(
        later > tool.at_s && port.now_s() - later < 0.4,
        "readings go on: {later} after {}",
        tool.at_s
    );
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_goals_of_tool_and_fingers_are_reached() {
    let ros = Ros::with_arm();
    let mut port = ros.connect();
    let up = above(&mut port, 0.1);
    let sent = [
        port.send_pose(&up).unwrap(),
        port.send_fingers(&[5000.0, 4000.0]).unwrap(),
    ];
    for goal in &sent {
        assert_eq!(
            outcome(&mut port, goal),
            Some(Ending::Succeeded),
            "{goal:?}"
        );
    }
    port.wait(0.3);
    let readings = port.state();
    assert!(distance(&readings.tool.unwrap().value, &up) < 1e-9);
    assert_eq!(readings.fingers.unwrap().value, [5000.0, 4000.0]);
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_a_goal_is_given_up_when_cancelled_or_when_another_comes() {
    let ros = Ros::with_arm();
    let mut port = ros.connect();
    let far = above(&mut port, 0.6);
    let sent = port.send_pose(&far).unwrap();
    let first = until_active(&mut port, sent);
    port.cancel(&first).unwrap();
    assert_eq!(outcome(&mut port, &first), Some(Ending::Preempted));
    port.wait(0.3);
    let stands = port.state().tool.unwrap().value;
    port.wait(0.5);
    assert_eq!(
        port.state().tool.unwrap().value,
        stands,
        "a cancelled motion has ended"
    );

    let sent = port.send_pose(&far).unwrap();
    let second = until_active(&mut port, sent);
    let near = above(&mut port, 0.02);
    let third = port.send_pose(&near).unwrap();
    assert_eq!(outcome(&mut port, &third), Some(Ending::Succeeded));
    assert_eq!(port.goal(&second), GoalState::Ended(Ending::Preempted));
    let unknown = GoalId("never sent".to_owned());
    assert_eq!(port.goal(&unknown), GoalState::Ended(Ending::Rejected));
    assert!(port.cancel(&unknown).is_err());
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_a_trajectory_is_followed() {
    let ros = Ros::with_arm();
    let settings = RosSettings {
        trajectory: Some(TRAJECTORY.to_owned()),
        ..ros.settings()
    };
    let mut port =
        fab_arm_ros::connect(&settings, super::nodes::MODEL, super::nodes::PATIENCE_S).unwrap();
    let start = port.state().joints_rad.unwrap().value;
    let moved = |by: f64| start.iter().map(|angle| angle + by).collect::<Vec<f64>>();
    let point = |at_s: f64, by: f64| Waypoint::at_rest(moved(by), at_s);
    let points = [point(0.0, 0.0), point(0.4, 0.2), point(0.8, 0.1)];
    let id = port.send_trajectory(&points).unwrap();
    assert_eq!(outcome(&mut port, &id), Some(Ending::Succeeded));
    port.wait(0.3);
    let found = port.state().joints_rad.unwrap().value;
    assert!(
        found
            .iter()
            .zip(moved(0.1))
            .all(|(found, sent)| (found - sent).abs() < 1e-12),
        "{found:?}"
    );
    // The node still accepts goals for the hand.
    let id = port.send_fingers(&[100.0, 100.0]).unwrap();
    assert_eq!(outcome(&mut port, &id), Some(Ending::Succeeded));
}
