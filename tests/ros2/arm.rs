//! An arm over ROS 2: its reported position, goals that it reaches or gives up, stops, and what is missing.

use super::nodes::{Driver, Ros, connect, outcome, until_active};
use fab_arm::port::{Ending, GoalId, GoalState, Port, Waypoint};
use fab_arm::rgbd::RgbdSource;
use fab_arm::settings::{Rmw, Ros2Settings};
use fab_arm_ros2::Ros2Port;
use std::time::{Duration, Instant};

/// Where the node's arm begins, radians.
const START: [f64; 6] = [4.8, 2.9, 1.0, 4.2, 1.4, 1.3];

/// Turns every joint by an angle and takes so long.
fn turned(by_rad: f64, takes_s: f64) -> [Waypoint; 2] {
    let point = |by_rad: f64, at_s: f64| {
        Waypoint::at_rest(START.map(|angle| angle + by_rad).to_vec(), at_s)
    };
    [point(0.0, 0.05), point(by_rad, takes_s)]
}

fn joints(port: &mut Ros2Port) -> Vec<f64> {
    port.state().joints_rad.unwrap().value
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_an_arm_says_where_it_is_and_reaches_its_goals() {
    for driver in [Driver::Gripper, Driver::ParallelGripper] {
        let ros = Ros::with_arm(driver);
        let mut port = ros.connect();
        assert_eq!(joints(&mut port), START);
        let first = port.state().tool.unwrap().at_s;
        port.wait(0.5);
        let later = port.state().tool.unwrap().at_s;
        assert!(
            later > first && port.now_s() - later < 0.4,
            "readings go on, whatever the other machine's clock: {later} after {first}"
        );
        let sent = [
            port.send_trajectory(&turned(0.2, 0.6)).unwrap(),
            port.send_fingers(&[5000.0; 2]).unwrap(),
        ];
        for goal in &sent {
            let ended = outcome(&mut port, goal);
            assert_eq!(ended, Some(Ending::Succeeded), "{driver:?} {goal:?}");
        }
        port.wait(0.3);
        for (found, from) in joints(&mut port).iter().zip(START) {
            assert!((found - from - 0.2).abs() < 1e-9, "{found} from {from}");
        }
        assert_eq!(port.state().fingers.unwrap().value, [5000.0, 5000.0]);
    }
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_a_goal_is_given_up_when_cancelled_and_all_are_when_stopped() {
    let ros = Ros::with_arm(Driver::Gripper);
    let mut port = ros.connect();
    let sent = port.send_trajectory(&turned(1.0, 20.0)).unwrap();
    let first = until_active(&mut port, sent);
    port.cancel(&first).unwrap();
    assert_eq!(outcome(&mut port, &first), Some(Ending::Preempted));

    let sent = port.send_trajectory(&turned(1.0, 20.0)).unwrap();
    let second = until_active(&mut port, sent);
    // Another program, as the watchdog is, which has sent nothing.
    let mut other = ros.connect();
    other.stop().unwrap();
    assert_eq!(outcome(&mut port, &second), Some(Ending::Preempted));
    port.wait(0.3);
    let stands = joints(&mut port);
    port.wait(0.5);
    assert_eq!(joints(&mut port), stands, "a stopped motion has ended");
    let unknown = GoalId("never sent".to_owned());
    assert_eq!(port.goal(&unknown), GoalState::Ended(Ending::Rejected));
    assert!(port.cancel(&unknown).is_err());

    let settings = Ros2Settings {
        stop: Some("/arm/stop".to_owned()),
        ..ros.settings()
    };
    let mut port = connect(&settings, 5.0).unwrap();
    let sent = port.send_fingers(&[60_000.0; 2]).unwrap();
    let third = until_active(&mut port, sent);
    port.stop().unwrap();
    assert!(matches!(
        outcome(&mut port, &third),
        Some(Ending::Preempted | Ending::Aborted)
    ));
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_a_goal_that_is_refused_says_so() {
    let ros = Ros::with_arm(Driver::Refuses);
    let mut port = ros.connect();
    let sent = port.send_trajectory(&turned(0.2, 0.6)).unwrap();
    assert_eq!(outcome(&mut port, &sent), Some(Ending::Rejected));
    assert_eq!(joints(&mut port), START);
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_what_is_missing_is_named() {
    let ros = Ros::with_arm(Driver::Gripper);
    drop(ros.connect());
    let settings = ros.settings();
    let text = |name: &str| Some(name.to_owned());
    let with = |change: fn(&mut Ros2Settings)| {
        let mut changed = settings.clone();
        change(&mut changed);
        changed
    };
    let cases: [(Ros2Settings, &str); 6] = [
        (
            with(|it| it.domain = 232),
            "nobody publishes `/joint_states`: is the driver started, and in the domain of `ros2.domain`?",
        ),
        (
            with(|it| it.joints[0] = "shoulder".to_owned()),
            "`/joint_states` cannot be used: it gives no position of the joint `shoulder`",
        ),
        (
            Ros2Settings {
                trajectory: text("/other/follow"),
                ..settings.clone()
            },
            "there is no action server `/other/follow`: is the controller active?",
        ),
        (
            with(|it| it.gripper_action = fab_arm::settings::GripperAction::ParallelGripperCommand),
            "the action server `/gripper/gripper_cmd` is another: it takes \
             `control_msgs::action::dds_::GripperCommand_SendGoal_Request_`, and not \
             `control_msgs::action::dds_::ParallelGripperCommand_SendGoal_Request_`",
        ),
        (
            with(|it| it.rmw = Rmw::Fastrtps),
            "the action server `/controller/follow_joint_trajectory` does not answer: does it use the middleware of \
             `ros2.rmw`, `fastrtps`?",
        ),
        (
            Ros2Settings {
                stop: text("/arm/halt"),
                ..settings.clone()
            },
            "there is no service `/arm/halt`: is the driver started?",
        ),
    ];
    for (settings, expected) in cases {
        let Err(error) = connect(&settings, 3.0) else {
            panic!("it connects, but {expected}");
        };
        assert_eq!(error.to_string(), expected);
    }
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_a_killed_node_is_an_error_within_seconds() {
    let mut ros = Ros::with_arm(Driver::Gripper);
    let mut port = ros.connect();
    let sent = port.send_trajectory(&turned(1.0, 20.0)).unwrap();
    let goal = until_active(&mut port, sent);
    ros.kill_node();
    port.wait(2.3);
    let began = Instant::now();
    let refused = port.send_fingers(&[60_000.0; 2]).unwrap_err();
    assert!(refused.why.contains("has been silent for 2."), "{refused}");
    let ended = port.goal(&goal);
    assert!(!matches!(ended, GoalState::Ended(Ending::Succeeded)));
    let unheard = port.stop().unwrap_err();
    assert_eq!(unheard.what, "the cancellation of every goal");
    assert!(unheard.why.contains("does not answer"), "{unheard}");
    assert!(
        began.elapsed() < Duration::from_secs(4),
        "{:?}",
        began.elapsed()
    );
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_a_camera_gives_colour_depth_and_projection_from_after_the_request() {
    let ros = Ros::with_arm(Driver::Gripper);
    let mut camera = fab_arm_ros2::subscribe(&ros.settings(), 20.0).unwrap();
    let shot = camera.shoot().unwrap();
    let size = shot.rgb.dimensions();
    assert_eq!(shot.depth_m.dimensions(), size);
    let lens = shot.intrinsics.unwrap();
    assert_eq!(lens.size_px, [size.0, size.1]);
    let is_whole = shot.rgb.enumerate_pixels().all(|(x, y, pixel)| {
        let [x, y] = [x as u8, y as u8];
        pixel.0 == [x, y, x ^ y]
    });
    assert!(is_whole, "another picture than the node's");
    let aside = Ros2Settings {
        color: Some("/camera/nothing".to_owned()),
        ..ros.settings()
    };
    let why = fab_arm_ros2::subscribe(&aside, 1.0)
        .unwrap()
        .shoot()
        .unwrap_err();
    assert_eq!(
        why,
        "nothing came on `/camera/nothing` within 1 s: is the camera's driver started?"
    );
}
