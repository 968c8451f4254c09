//! Missing nodes and broken connections: reported in words, in time, without waiting forever.

use super::nodes::{MODEL, Ros, TRAJECTORY, free_port, outcome, until_active};
use fab_arm::port::{Ending, GoalState, Port};
use fab_arm::settings::RosSettings;
use fab_arm_ros::RosError;
use std::time::{Duration, Instant};

/// Tries to connect and fails in time; returns the message.
fn refusal(settings: &RosSettings, model: &str, timeout_s: f64) -> String {
    let began = Instant::now();
    let Err(error) = fab_arm_ros::connect(settings, model, timeout_s) else {
        panic!("it connects");
    };
    let took = began.elapsed();
    assert!(
        took < Duration::from_secs_f64(timeout_s + 2.5),
        "{took:?}: {error}"
    );
    error.to_string()
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_what_is_missing_is_named() {
    let ros = Ros::master();
    let settings = ros.settings();
    let dead = RosSettings {
        master: format!("http://127.0.0.1:{}", free_port()),
        ..settings.clone()
    };
    let said = refusal(&dead, MODEL, 5.0);
    assert!(
        said.starts_with(&format!(
            "no master at {}: is roscore running? (",
            dead.master
        )),
        "{said}"
    );
    assert_eq!(
        refusal(&settings, MODEL, 1.0),
        "the node `/j2n6s200_driver` does not publish `out/tool_pose`, `out/joint_state`, `out/finger_position`: is the driver started?"
    );
    let elsewhere = RosSettings {
        host: Some("robot.example".to_owned()),
        ..settings.clone()
    };
    assert!(matches!(
        fab_arm_ros::connect(&elsewhere, MODEL, 5.0),
        Err(RosError::Host { expected, .. }) if expected == "robot.example"
    ));
    for (arm, model, expected) in [
        (
            "j2n6s200_driver",
            MODEL,
            "`arm` is `j2n6s200_driver`; expected `/j2n6s200_driver`",
        ),
        (
            "/arm",
            "jaco",
            "the model `jaco` is not of the form `j2n6s200`",
        ),
    ] {
        let settings = RosSettings {
            arm: arm.to_owned(),
            ..settings.clone()
        };
        assert_eq!(refusal(&settings, model, 1.0), expected);
    }
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_an_arm_of_another_model_is_not_believed() {
    let ros = Ros::with_arm();
    drop(ros.connect());
    let three_fingers = refusal(&ros.settings(), "j2n6s300", 2.0);
    assert!(
        three_fingers
            .contains("is in the frame `j2n6s200_link_base`, and not in `j2n6s300_link_base`"),
        "{three_fingers}"
    );
    let elsewhere = RosSettings {
        trajectory: Some("/other/follow".to_owned()),
        ..ros.settings()
    };
    // Long enough for the other server to be heard on a busy machine.
    assert_eq!(
        refusal(&elsewhere, MODEL, 8.0),
        "there is no action server `/other/follow`: is the driver started?"
    );
    let settings = RosSettings {
        trajectory: Some(TRAJECTORY.to_owned()),
        ..ros.settings()
    };
    assert!(fab_arm_ros::connect(&settings, MODEL, 5.0).is_ok());
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_a_killed_node_is_an_error_within_seconds() {
    let mut ros = Ros::with_arm();
    let mut port = ros.connect();
    let sent = port.send_fingers(&[60_000.0; 2]).unwrap();
    let goal = until_active(&mut port, sent);
    ros.kill_node();
    port.wait(1.3);
    let began = Instant::now();
    let refused = port.send_fingers(&[60_000.0; 2]).unwrap_err();
    assert!(refused.why.contains("has been silent for 1."), "{refused}");
    let last = port.state().fingers.unwrap().at_s;
    assert!(
        port.now_s() - last > 1.0,
        "no reading is newer than the node's end"
    );
    assert!(!matches!(
        port.goal(&goal),
        GoalState::Ended(Ending::Succeeded)
    ));
    let unheard = port.stop().unwrap_err();
    assert_eq!(unheard.what, "the service `/j2n6s200_driver/in/stop`");
    assert!(
        began.elapsed() < Duration::from_secs(4),
        "{:?}",
        began.elapsed()
    );
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_a_node_that_comes_back_is_not_handed_an_old_goal() {
    let mut ros = Ros::with_arm();
    let mut port = ros.connect();
    let sent = port.send_fingers(&[60_000.0; 2]).unwrap();
    let goal = until_active(&mut port, sent);
    ros.kill_node();
    port.wait(0.5);
    ros.start_node();
    let deadline = Instant::now() + Duration::from_secs(30);
    // Only a status list of the new node can show that it does not know the goal.
    while port.goal(&goal) == GoalState::Active && Instant::now() < deadline {
        port.wait(0.1);
    }
    assert_eq!(port.goal(&goal), GoalState::Ended(Ending::Aborted));
    port.wait(1.0);
    assert_eq!(
        port.state().fingers.unwrap().value,
        [0.0, 0.0],
        "the new node moves nothing"
    );
    let goal = port.send_fingers(&[100.0; 2]).unwrap();
    assert_eq!(outcome(&mut port, &goal), Some(Ending::Succeeded));
    port.stop().unwrap();
}
