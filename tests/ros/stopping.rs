//! A stopped arm: it does not move, whatever is requested, until it is started.

use super::nodes::{Ros, outcome, until_active};
use fab_arm::port::{Ending, GoalId, Port};
use fab_arm_ros::RosPort;

fn fingers(port: &mut RosPort, position: f64) -> GoalId {
    port.send_fingers(&[position; 2]).unwrap()
}

fn closing(port: &mut RosPort) -> GoalId {
    let sent = fingers(port, 60_000.0);
    until_active(port, sent)
}

fn position(port: &mut RosPort) -> f64 {
    port.state().fingers.unwrap().value[0]
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_a_stop_ends_a_motion_and_every_goal_until_a_start() {
    let ros = Ros::with_arm();
    let mut port = ros.connect();
    let moving = closing(&mut port);
    port.stop().unwrap();
    assert_eq!(outcome(&mut port, &moving), Some(Ending::Aborted));
    port.wait(0.3);
    let stands = position(&mut port);
    let refused = fingers(&mut port, 0.0);
    assert_eq!(outcome(&mut port, &refused), Some(Ending::Aborted));
    port.wait(0.5);
    assert_eq!(position(&mut port), stands);
    port.start().unwrap();
    let taken = fingers(&mut port, stands + 10.0);
    assert_eq!(outcome(&mut port, &taken), Some(Ending::Succeeded));
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_an_arm_stays_stopped_though_a_cancellation_was_under_way() {
    let ros = Ros::with_arm();
    let mut port = ros.connect();
    let moving = closing(&mut port);
    port.cancel(&moving).unwrap();
    port.stop().unwrap();
    port.wait(0.5);
    let refused = fingers(&mut port, 0.0);
    assert_eq!(outcome(&mut port, &refused), Some(Ending::Aborted));
}
