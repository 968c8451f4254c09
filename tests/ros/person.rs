//! A person beside the arm: recovers and enables it after a program was killed, and guides it from point to point.

use super::lab::{Lab, Run};
use super::nodes::Driver;
use fab_arm::calibration::read_pairs;
use fab_arm::driver::{Commands, PortArm};
use fab_arm::guard::Guard;
use fab_arm::kinematics::tool_down::tool_down;
use fab_arm::limits::Limited;
use fab_arm::port::Port;
use nalgebra::{Point3, Vector3};
use std::io::{BufRead, BufReader, Lines, Write};
use std::process::{ChildStderr, Stdio};
use std::time::{Duration, Instant};

/// Runs a command; returns its exit code and output.
fn said(lab: &Lab, arguments: &[&str]) -> (Option<i32>, String) {
    let output = lab.fabc().args(arguments).output().unwrap();
    let both = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(both).unwrap())
}

/// Waits until the watchdog has stopped the arm.
fn until_stopped(lab: &mut Lab) {
    let deadline = Instant::now() + Duration::from_secs(30);
    while !lab.truth().is_stopped {
        assert!(Instant::now() < deadline, "nobody stops the arm");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_an_arm_whose_program_was_killed_is_refused_until_a_person_has_seen_to_it() {
    let mut lab = Lab::new(Driver::Kinova, 41);
    super::touching::calibrate(&mut lab, super::touching::Touching::Reckoned);
    lab.lay();
    let mut run: Run = lab.run();
    run.until("over");
    // Before it moves, nothing is watched and nothing needs to be stopped.
    std::thread::sleep(super::rollouts::UNDER_WAY);
    run.signal("KILL");
    run.end();
    until_stopped(&mut lab);
    let again = [
        "run",
        &super::lab::project("tasks/real/double_triangle.fab"),
        "--world",
        "jaco",
        "--robot",
        "robot.toml",
        "--confirm",
        "none",
        "--out",
        "again",
    ];
    let (code, text) = said(&lab, &again);
    assert_eq!(code, Some(2), "{text}");
    for words in [
        "nothing is moved, because of how the last run with the arm of `robot.toml` ended: `over` of action 1 was begun",
        "the hand may hold cloth",
        "`fabc robot recover --robot robot.toml`",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let stood = lab.truth();
    assert!(stood.is_stopped);
    let recover = |how| ["robot", "recover", "--robot", "robot.toml", "--how", how];
    let (code, text) = said(&lab, &recover(" "));
    assert_eq!((code, lab.truth().is_stopped), (Some(2), true), "{text}");
    let (code, text) = said(&lab, &recover("taken out, the way is free"));
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("the arm accepts motion again"), "{text}");
    let now = lab.truth();
    assert!(!now.is_stopped);
    let moved_m = (Vector3::from(now.tool_m) - Vector3::from(stood.tool_m)).norm();
    assert!(moved_m < 0.003, "to be let go moved it by {moved_m} m");
    let journal = std::fs::read_to_string(lab.folder().join("run/arm.jsonl")).unwrap();
    let ends = "{\"type\":\"recovered\",\"how\":\"taken out, the way is free\"}\n";
    assert!(journal.ends_with(ends), "{journal}");
    // It stands over the cloth, and nobody has moved it away.
    let (code, text) = said(&lab, &again);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("and not at `rest_m`"), "{text}");
}

/// Reads lines until one contains the words, and returns it.
fn line_with(lines: &mut Lines<BufReader<ChildStderr>>, words: &str) -> String {
    let mut all = String::new();
    for line in lines {
        let line = line.unwrap();
        if line.contains(words) {
            return line;
        }
        all += &format!("{line}\n");
    }
    panic!("no `{words}` in:\n{all}");
}

#[test]
#[ignore = "needs ROS"]
fn peer_ros_an_arm_that_is_guided_gives_its_places() {
    let lab = Lab::new(Driver::Kinova, 42);
    let settings = lab.settings();
    let mut child = lab
        .fabc()
        .args(["calibrate", "--robot", "robot.toml", "--jog"])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut typed = child.stdin.take().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    line_with(&mut lines, "type `u,v`");
    // Another client moves the arm, like a joystick.
    let port = lab.ros.connect();
    let guard = Guard::level(&settings);
    let (fingers, tolerance) = (settings.fingers, settings.tolerance);
    let arm = PortArm::new(Box::new(port), Commands::Poses, fingers, tolerance);
    let mut arm = Limited::new(arm, guard);
    let mut places = Vec::new();
    for (at, pixel) in [
        ([0.40, -0.10, 0.02], "150,200"),
        ([0.52, 0.12, 0.02], "300.5,100"),
    ] {
        let to = tool_down(&Point3::from(at), 0.0);
        let state = arm.move_tool(&to, 0.2, &mut |_| Ok(())).unwrap();
        places.push(state.tool.translation.vector);
        writeln!(typed, "{pixel}").unwrap();
        line_with(&mut lines, &format!("point {}: added", places.len()));
    }
    // While the arm moves, its position is not accepted.
    let away = tool_down(&Point3::new(0.35, -0.30, 0.25), 0.0);
    let mut is_asked = false;
    arm.move_tool(&away, 0.2, &mut |state| {
        let way_m = (state.tool.translation.vector - places[1]).norm();
        if !is_asked && way_m > 0.02 {
            is_asked = true;
            writeln!(typed, "200,200").unwrap();
        }
        Ok(())
    })
    .unwrap();
    line_with(
        &mut lines,
        "error: the arm still moves, or reports nothing new",
    );
    drop(typed);
    // Two points are too few; they are saved.
    assert_eq!(child.wait().unwrap().code(), Some(2));
    let kept = read_pairs(&lab.folder().join("lab.calibration.pairs.csv"), Ok(&[])).unwrap();
    assert_eq!(kept.len(), 2);
    for (pair, place) in kept.iter().zip(&places) {
        let off_m = (Vector3::from(pair.base_m) - place).norm();
        assert!(off_m < 0.001, "{pair:?}: {place:?}");
    }
    assert_eq!(kept[1].pixel, [300.5, 100.0]);
    assert!(arm.arm().port().state().tool.is_some());
}
