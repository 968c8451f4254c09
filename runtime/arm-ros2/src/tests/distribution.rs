//! The connection, tested with a distribution of ROS 2 itself: its client library and its default middleware.

#![allow(clippy::unwrap_used)]

use super::action::{Action, ActionClient, Server};
use super::link::Link;
use super::readings::{JointStates, Names};
use fab_arm::kinematics::chain::Chain;
use fab_arm::port::{Ending, GoalState};
use fab_arm::settings::{GripperAction, Rmw, Ros2Settings};
use serde::{Deserialize, Serialize};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

/// The action of the node, of another type than an arm's.
struct Count;

#[derive(Serialize)]
struct Order {
    order: i32,
}

#[derive(Deserialize)]
struct Sequence {
    #[allow(dead_code)]
    sequence: Vec<i32>,
}

impl Action for Count {
    const TYPES: [&'static str; 2] = [
        "test_msgs::action::dds_::Fibonacci_SendGoal",
        "test_msgs::action::dds_::Fibonacci_GetResult",
    ];
    type Goal = Order;
    type Result = Sequence;
}

struct Node(Child);

impl Drop for Node {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A domain that hardly anybody else on this machine uses.
fn domain() -> u16 {
    92 + (std::process::id() % 8) as u16
}

fn start() -> Node {
    let python = std::env::var("FABC_PEER_RCLPY").expect("make test-all sets FABC_PEER_RCLPY");
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/peers/ros2_rclpy.py"
    );
    let child = Command::new(python)
        .arg(script)
        .env("ROS_DOMAIN_ID", domain().to_string())
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
        .spawn();
    Node(child.unwrap())
}

fn settings() -> Ros2Settings {
    Ros2Settings {
        domain: domain(),
        rmw: Rmw::Fastrtps,
        interface: Some("127.0.0.1".to_owned()),
        joint_states: "/joint_states".to_owned(),
        joints: (1..=6).map(|joint| format!("joint_{joint}")).collect(),
        trajectory: None,
        gripper: None,
        gripper_action: GripperAction::GripperCommand,
        gripper_joints: vec!["finger".to_owned()],
        gripper_effort: 0.0,
        stop: None,
        color: None,
        depth: None,
        info: None,
    }
}

/// Waits until something holds.
fn until(what: &str, holds: impl Fn() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(20);
    while !holds() {
        assert!(Instant::now() < deadline, "{what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
#[ignore = "needs ROS 2"]
fn peer_ros2_a_distribution_takes_refuses_and_cancels_goals_and_says_where_the_arm_is() {
    let _node = start();
    let settings = settings();
    let link = Link::open(&settings).unwrap();
    let count: ActionClient<Count> = ActionClient::open(&link, "/count", Rmw::Fastrtps).unwrap();
    let names = Names {
        joints: settings.joints.clone(),
        fingers: settings.gripper_joints.clone(),
        n_fingers: 2,
    };
    let chain = Chain::of_model("j2n6s200").unwrap();
    let clock = Instant::now();
    let states = JointStates::open(&link, "/joint_states", names, chain, clock).unwrap();
    until("no joint states", || states.readings().fingers.is_some());
    let readings = states.readings();
    assert_eq!(
        readings.joints_rad.unwrap().value,
        [4.8, 2.9, 1.0, 4.2, 1.4, 1.3]
    );
    assert_eq!(readings.fingers.unwrap().value, [0.5, 0.5]);

    until("no server", || count.is_found(&link).unwrap());
    assert!(count.wait_until_it_answers(Instant::now() + Duration::from_secs(10)));
    for (order, expected) in [(5, Ending::Succeeded), (-1, Ending::Rejected)] {
        let id = count.send(Order { order }).unwrap();
        until("no end", || {
            count.state(&id) == Some(GoalState::Ended(expected))
        });
    }
    let id = count.send(Order { order: 100 }).unwrap();
    let is = |id: &str, state: GoalState| count.state(id) == Some(state);
    until("not active", || is(&id, GoalState::Active));
    count.cancel(&id).unwrap();
    until("not cancelled", || {
        is(&id, GoalState::Ended(Ending::Preempted))
    });

    let id = count.send(Order { order: 100 }).unwrap();
    until("not active", || is(&id, GoalState::Active));
    // Another client, which has sent nothing.
    let other = Link::open(&settings).unwrap();
    let stopper: ActionClient<Count> = ActionClient::open(&other, "/count", Rmw::Fastrtps).unwrap();
    let deadline = Instant::now() + Duration::from_secs(10);
    assert!(stopper.wait_until_it_answers(deadline));
    stopper.cancel_all(deadline).unwrap();
    until("not stopped", || {
        is(&id, GoalState::Ended(Ending::Preempted))
    });
    until("the other does not see it end", || {
        !stopper.has_goals(GoalState::Active)
    });
}

/// A watchdog stops the arm from its own thread.
#[test]
fn ports_and_cameras_are_send() {
    fn assert_send<T: Send>() {}
    assert_send::<super::Ros2Port>();
    assert_send::<fab_arm::rgbd::topics::TopicCamera<Link>>();
}
