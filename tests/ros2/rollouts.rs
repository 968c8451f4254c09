//! Rollouts over ROS 2: a fold, and runs that a person, the controller or a lost node ends. Each ends in a named outcome.

use super::lab::{Ended, Lab, Run};
use super::nodes::Driver;
use super::touching::{Touching, calibrate};
use super::whole::folds_a_double_triangle;
use serde_json::Value;
use std::time::Duration;

/// How long the arm is under way when something happens.
const UNDER_WAY: Duration = Duration::from_millis(200);

/// Movement of a tool that has come to rest, metres.
const STILL_M: f64 = 0.0005;

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_an_arm_moved_by_trajectories_folds_a_double_triangle() {
    folds_a_double_triangle(Driver::Gripper, 3);
}

/// A lab with a cloth, in which a fold has begun.
fn begun(driver: Driver, seed: u64) -> (Lab, Run) {
    let mut lab = Lab::new(driver, seed);
    calibrate(&mut lab, Touching::Reckoned);
    lab.lay();
    let run = lab.run();
    (lab, run)
}

fn failed(ended: &Ended, why: &str) {
    assert_eq!(ended.code, Some(2), "{ended:#?}");
    assert_eq!(ended.report["outcome"], "world_failed", "{ended:#?}");
    assert!(ended.why.contains(why), "{ended:#?}");
    assert!(!ended.stderr.contains("panicked"), "{ended:#?}");
}

fn halted(ended: &Ended) -> Value {
    let last = ended.journal.lines().last().unwrap();
    let entry: Value = serde_json::from_str(last).unwrap();
    assert_eq!(entry["type"], "halted", "{ended:#?}");
    entry["stopped"].clone()
}

fn is_still(lab: &mut Lab) {
    let before = lab.truth().tool_m;
    std::thread::sleep(Duration::from_secs(1));
    let moved = lab.truth().tool_m.into_iter().zip(before);
    let moved_m = moved.map(|(now, then)| (now - then).abs());
    assert!(moved_m.fold(0.0, f64::max) < STILL_M);
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_an_interrupted_run_stops_the_arm() {
    let (mut lab, mut run) = begun(Driver::ParallelGripper, 10);
    run.until("over");
    std::thread::sleep(UNDER_WAY);
    run.signal("INT");
    let ended = run.end();
    assert_eq!(ended.code, Some(130), "{ended:#?}");
    assert_eq!(ended.report["outcome"], "interrupted", "{ended:#?}");
    assert_eq!(halted(&ended), true);
    is_still(&mut lab);
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_the_watchdog_of_a_killed_run_stops_the_arm() {
    let (mut lab, mut run) = begun(Driver::Gripper, 11);
    run.until("over");
    std::thread::sleep(UNDER_WAY);
    run.signal("KILL");
    let ended = run.end();
    assert_eq!(ended.code, None, "{ended:#?}");
    // It stops once the pipe is closed, and waits for rest.
    std::thread::sleep(Duration::from_secs(3));
    is_still(&mut lab);
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_a_controller_that_refuses_ends_the_run() {
    let (mut lab, run) = begun(Driver::Refuses, 12);
    failed(&run.end(), "reported `refused`");
    is_still(&mut lab);
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_a_controller_that_does_nothing_ends_the_run() {
    let (mut lab, run) = begun(Driver::Ignores, 13);
    failed(&run.end(), "did not end within");
    is_still(&mut lab);
}

#[test]
#[ignore = "needs Cyclone DDS"]
fn peer_ros2_a_node_lost_in_mid_motion_ends_the_run() {
    let (mut lab, mut run) = begun(Driver::Gripper, 14);
    run.until("over");
    std::thread::sleep(UNDER_WAY);
    lab.ros.kill_node();
    let ended = run.end();
    failed(&ended, "has not reported for");
    assert_eq!(halted(&ended), false, "nobody acknowledged a stop");
}
