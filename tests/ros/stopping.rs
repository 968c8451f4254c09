//! A stopped arm: it does not move, whatever is requested, until it is started.

use super::nodes::{Ros, outcome, send_until_active};
use fab_arm::port::{Ending, Goal, Port};
use fab_arm_ros::RosPort;

fn fingers(position: f64) -> Goal {
    Goal::Fingers(vec![position; 2])
}

fn position(port: &mut RosPort) -> f64 {
    port.readings().fingers.unwrap().value[0]
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_a_stop_ends_a_motion_and_every_goal_until_a_start() {
    let ros = Ros::with_arm();
    let mut port = ros.connect();
    let moving = send_until_active(&mut port, &fingers(60_000.0));
    port.stop().unwrap();
    assert_eq!(outcome(&mut port, &moving), Some(Ending::Aborted));
    port.wait(0.3);
    let stands = position(&mut port);
    let refused = port.send(&fingers(0.0)).unwrap();
    assert_eq!(outcome(&mut port, &refused), Some(Ending::Aborted));
    port.wait(0.5);
    assert_eq!(position(&mut port), stands);
    port.start().unwrap();
    let taken = port.send(&fingers(stands + 10.0)).unwrap();
    assert_eq!(outcome(&mut port, &taken), Some(Ending::Succeeded));
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_an_arm_stays_stopped_though_a_cancellation_was_under_way() {
    let ros = Ros::with_arm();
    let mut port = ros.connect();
    let moving = send_until_active(&mut port, &fingers(60_000.0));
    port.cancel(&moving).unwrap();
    port.stop().unwrap();
    port.wait(0.5);
    let refused = port.send(&fingers(0.0)).unwrap();
    assert_eq!(outcome(&mut port, &refused), Some(Ending::Aborted));
}
