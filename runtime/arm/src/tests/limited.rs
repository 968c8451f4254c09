//! Tests that motions which pass the guard stay within the limits, and that a moving arm is stopped at them.

use super::*;
use crate::driver::Opening;
use crate::kinematics::reach::Reach;
use crate::kinematics::tool_down::tool_down;
use crate::route::Act;
use crate::settings::KeepOut;
use nalgebra::{Quaternion, Translation3, UnitQuaternion};

/// Settings with a lamp on the table.
fn with_lamp() -> Settings {
    let mut settings = settings();
    settings.workspace.keep_out = vec![KeepOut {
        name: "lamp".to_owned(),
        min_m: [0.55, 0.10, 0.0],
        max_m: [0.65, 0.20, 0.30],
    }];
    settings
}

/// A state with the tool at a pose, and joint angles if the hand is down at a place within reach.
fn at(tool: Isometry3<f64>) -> ArmState {
    let here = Point3::from(tool.translation.vector);
    let found = ArmState::hand_down(&settings(), &here);
    ArmState {
        at_s: 0.0,
        tool,
        joints_rad: found.map_or(Vec::new(), |found| found.joints_rad),
        fingers: Vec::new(),
    }
}

fn down(point: [f64; 3]) -> Isometry3<f64> {
    tool_down(&point.into(), 0.0)
}

/// The hand is 0.14 m wide: its middle is kept farther away than the tool's tolerance.
#[test]
fn the_hand_is_kept_away_and_not_only_its_middle() {
    let guard = guard(&with_lamp());
    let allowed = |from, to| guard.motion(&at(down(from)), &down(to), 0.1).map(drop);
    allowed([0.40, -0.10, 0.10], [0.40, 0.40, 0.10]).unwrap();
    for (from, to) in [
        ([0.50, -0.10, 0.10], [0.50, 0.40, 0.10]), // past it, the middle at 50 mm
        ([0.40, 0.15, 0.10], [0.52, 0.15, 0.10]),
        ([0.40, 0.15, 0.33], [0.60, 0.15, 0.33]), // over it, the middle at 30 mm
    ] {
        let why = allowed(from, to).unwrap_err();
        assert!(why.contains("the hand would be within"), "{why}");
        assert!(why.contains("`lamp`"), "{why}");
    }
}

/// A hand that came to rest too near to a zone must not be trapped there.
#[test]
fn a_hand_near_a_zone_may_go_away_from_it() {
    let guard = guard(&with_lamp());
    let allowed = |from, to| guard.motion(&at(down(from)), &down(to), 0.1).is_ok();
    let place = |x: f64| [x, 0.15, 0.10];
    let allowed_at = |x: f64| allowed(place(0.40), place(x));
    // The last place that is allowed, and one 4 mm nearer.
    let mut last = 0.40;
    while allowed_at(last + 0.001) {
        last += 0.001;
    }
    let near = place(last + 0.004);
    assert!(allowed(near, place(0.40)));
    for to in [
        near,
        place(last + 0.005),
        place(0.75 - 0.01),
        [last + 0.004, 0.18, 0.10],
    ] {
        assert!(!allowed(near, to), "{to:?}");
    }
    assert!(
        !allowed(place(last + 0.02), place(0.40)),
        "the hand is in the lamp"
    );
}

/// The tool stays where the box allows it, and a link behind it would pass through the zone.
#[test]
fn links_are_kept_away_too() {
    let mut settings = settings();
    let guard_of = |settings: &Settings| guard(settings);
    let chain = Chain::of_model(&settings.model).unwrap();
    let reach = Reach::tool_down(&chain, 0.0);
    let here = [0.45, -0.15, 0.10];
    let from = ArmState {
        joints_rad: reach.check(&here.into(), &[0.1]).unwrap(),
        ..at(down(here))
    };
    let to = down([0.45, 0.15, 0.10]);
    guard_of(&settings).motion(&from, &to, 0.1).unwrap();
    // Where the elbow is half way, far above the hand.
    let middle = guard_of(&settings).motion(&from, &to, 0.1).unwrap();
    let middle = &middle.get().waypoints[middle.get().waypoints.len() / 2].joints_rad;
    let elbow = chain.frames(middle).unwrap()[2].translation.vector;
    settings.workspace.keep_out = vec![KeepOut {
        name: "shelf".to_owned(),
        min_m: [elbow.x - 0.01, elbow.y - 0.01, elbow.z - 0.01],
        max_m: [elbow.x + 0.01, elbow.y + 0.01, elbow.z + 0.01],
    }];
    let why = guard_of(&settings).motion(&from, &to, 0.1).unwrap_err();
    assert!(why.contains("the arm behind joint"), "{why}");
    // Measured angles are checked in the same way, while the arm moves.
    let state = ArmState {
        tool: chain.base_from_tool(middle).unwrap(),
        joints_rad: middle.clone(),
        ..from
    };
    let why = guard_of(&settings).measured(&state).unwrap_err();
    assert!(why.contains("`shelf`"), "{why}");
}

#[test]
fn a_tilted_table_is_followed() {
    let settings = settings();
    let slope = 3f64.to_radians().tan();
    let surface = Surface::tilted([0.02 - 0.45 * slope, slope, 0.0]);
    let guard = Guard::new(&settings, surface);
    let touch = |x: f64, above_m: f64| {
        let z = 0.02 + (x - 0.45) * slope + above_m;
        let from = at(down([x, 0.0, z + 0.05]));
        guard.motion(&from, &down([x, 0.0, z]), 0.1).map(drop)
    };
    for x in [0.35, 0.45, 0.55] {
        touch(x, 0.0).unwrap();
        let why = touch(x, -0.002).unwrap_err();
        // The path ends where it is first too low.
        assert!(why.ends_with(" mm below the table"), "{why}");
    }
}

#[test]
fn a_pose_that_is_none_is_refused() {
    let guard = guard(&with_lamp());
    let here = down([0.4, 0.3, 0.2]);
    let check = |from: &Isometry3<f64>, to: &Isometry3<f64>, speed_m_s| {
        guard.motion(&at(*from), to, speed_m_s).map(drop)
    };
    check(&here, &down([0.4, 0.2, 0.2]), 0.1).unwrap();
    for broken in [
        Quaternion::new(f64::NAN, 0.0, 0.0, 0.0),
        Quaternion::new(0.0, 1.0, f64::NAN, 0.0),
        Quaternion::new(f64::INFINITY, 0.0, 0.0, 0.0),
        Quaternion::new(0.0, 0.0, 0.0, 0.0),
    ] {
        let mut to = here;
        to.rotation = UnitQuaternion::new_unchecked(broken);
        assert!(check(&here, &to, 0.1).is_err(), "{broken}");
    }
    for axis in 0..3 {
        let mut to = here;
        to.translation = Translation3::from(here.translation.vector);
        to.translation.vector[axis] = f64::NAN;
        assert!(check(&here, &to, 0.1).is_err());
        assert!(check(&to, &here, 0.1).is_err());
    }
    for speed_m_s in [0.0, -0.1, 0.21, f64::NAN, f64::INFINITY] {
        assert!(check(&here, &down([0.4, 0.2, 0.2]), speed_m_s).is_err());
    }
    for joints_rad in [vec![f64::NAN; 6], vec![0.0; 5], vec![f64::INFINITY; 6]] {
        let from = ArmState {
            joints_rad,
            ..at(here)
        };
        assert!(guard.motion(&from, &down([0.4, 0.2, 0.2]), 0.1).is_err());
    }
}

#[test]
fn what_is_refused_does_not_move() {
    let mut bench = Bench::with(&[]);
    let outside = tool_down(&Point3::new(0.4, -0.3, 0.0), 0.0);
    let refused = bench.arm.move_tool(&outside, SPEED_M_S, &mut nobody);
    assert!(matches!(refused, Err(ArmError::Refused(_))), "{refused:?}");
    let fast = bench
        .arm
        .move_tool(&tool_down(&PICK_M.into(), 0.0), 0.5, &mut nobody);
    assert!(matches!(fast, Err(ArmError::Refused(_))), "{fast:?}");
    assert!(bench.off_m(bench.settings.workspace.rest_m) < 1e-6);
}

/// How far a runaway arm leaves its box before it is stopped.
#[test]
fn an_arm_that_runs_away_is_stopped_at_its_limits() {
    let mut bench = Bench::with(&[(FaultKind::Runaway, 0.8)]);
    let aside = tool_down(&Point3::new(0.45, 0.5, 0.1), 0.0);
    bench
        .arm
        .move_tool(&aside, SPEED_M_S, &mut nobody)
        .unwrap_err();
    bench.driver().stop().unwrap();
    bench.stays_stopped();
}

#[test]
fn an_arm_that_runs_away_before_its_motion_is_stopped() {
    let mut bench = Bench::with(&[(FaultKind::Runaway, 0.0)]);
    let aside = tool_down(&Point3::new(0.45, 0.5, 0.1), 0.0);
    let moved = bench.arm.move_tool(&aside, SPEED_M_S, &mut nobody);
    assert!(matches!(moved, Err(ArmError::OutOfLimits(_))), "{moved:?}");
    assert!(bench.off_m(bench.settings.workspace.rest_m) < 0.1);
}

#[test]
fn a_hand_that_is_carried_off_while_its_fingers_move_is_stopped() {
    let mut bench = Bench::with(&[(FaultKind::Runaway, 0.3)]);
    let closed = bench.arm.move_fingers(Opening::Closed, &mut nobody);
    assert!(
        matches!(closed, Err(ArmError::OutOfLimits(_))),
        "{closed:?}"
    );
}

/// A port sends what it is given. Only checked goals are given to it: `Goal` takes nothing else, and nothing but `Goal`
/// sends.
#[test]
fn motions_are_sent_in_one_place() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut senders = Vec::new();
    let mut folders = vec![crates.join("runtime"), crates.join("src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            if path.is_dir() && !["tests", "examples"].contains(&name.as_str()) {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                if [".send_pose(", ".send_trajectory("]
                    .iter()
                    .any(|it| text.contains(it))
                {
                    senders.push(name);
                }
            }
        }
    }
    senders.sort();
    assert_eq!(senders, ["goal.rs"]);
}

/// A folded elbow brings the wrist to the upper arm.
#[test]
fn parts_of_the_arm_that_touch_stop_it_and_those_that_always_do_are_named() {
    let settings = settings();
    let guard = guard(&settings);
    let names = guard.touching().iter().map(|pair| pair.join(", "));
    let expected = [
        "the arm behind joint 3, the arm behind joint 5",
        "the arm behind joint 4, the hand",
    ];
    assert_eq!(names.collect::<Vec<_>>(), expected);
    // So near to the base the elbow is folded.
    let near = Point3::new(0.19, 0.0, 0.02);
    let reach = Reach::tool_down(settings.chain(), 0.0);
    let folded = ArmState {
        joints_rad: reach.check(&near, &[]).unwrap(),
        ..at(tool_down(&near, 0.0))
    };
    let parts = "the arm behind joint 2 is within 0 mm of the arm behind joint 4";
    let why = guard.measured(&folded).unwrap_err();
    assert!(why.starts_with(parts), "{why}");
    let over = down([0.19, 0.0, 0.1]);
    let why = guard.motion(&folded, &over, SPEED_M_S).unwrap_err();
    let parts = "the arm behind joint 2 would be within 0 mm of the arm behind joint 4";
    assert_eq!(why, parts);
}

/// An arm that is where the route begins makes the planned motions; one that was moved meanwhile gets another.
#[test]
fn what_was_checked_is_what_is_sent() {
    for is_moved in [false, true] {
        let mut bench = Bench::driven(By::Trajectories, &[]);
        let (here, route) = (bench.driver().state().unwrap(), bench.route());
        bench.arm.plan(&route.motions);
        if is_moved {
            let aside = Translation3::new(0.0, 0.0, 0.03) * here.tool;
            let moved = bench.arm.move_tool(&aside, SPEED_M_S, &mut nobody);
            moved.unwrap();
        }
        let mut left = route.motions.len();
        for segment in &route.segments {
            if let Act::Move(to) = segment.act {
                _ = bench.arm.move_tool(&to, segment.speed_m_s, &mut nobody);
                left -= 1;
            }
        }
        assert_eq!(bench.arm.planned.len() == left, !is_moved);
    }
}
