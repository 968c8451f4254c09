//! Tests that motions keep the limits of the joints, and that the arm keeps the times that are stated.

use super::judged::{settings_text, target};
use super::*;
use crate::driver::ArmError;
use crate::kinematics::tool_down::tool_down;
use crate::plan::Plan;
use crate::route::{Act, Segment, SegmentName};
use crate::timing::JointLimits;
use fab_base::chance::Chance;
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::FRAC_PI_2;

/// How far a limit may be exceeded, as a share of it: rounding.
const EXACT: f64 = 1e-6;

/// How far the tool's own speed may be exceeded, as a share of it: between the points that were solved, joints bend the
/// path a little.
const TOOL: f64 = 0.02;

/// How far the tool may leave its line, metres, as `docs/arm.md` states.
const BESIDE_M: f64 = 1e-3;

/// How far the simulated arm may be from a stated time, as a share of it.
const KEPT: f64 = 0.05;

/// The speeds that the vendor's data sheets state, degrees/s.
const SPEEDS_DEG_S: [f64; 6] = [36.0, 36.0, 36.0, 48.0, 48.0, 48.0];

/// Checks what the joints do in a motion, from where they are.
fn keeps_limits(
    guard: &Guard,
    limits: &JointLimits,
    from: &ArmState,
    motion: &crate::guard::Motion,
) {
    let waypoints = &motion.waypoints;
    let (Some(first), Some(last)) = (waypoints.first(), waypoints.last()) else {
        panic!("no waypoints");
    };
    if waypoints.len() == 1 {
        assert_eq!(first.at_s, 0.0);
        return;
    }
    assert_eq!(first.at_s, 0.0);
    let step_s = last.at_s / (waypoints.len() - 1) as f64;
    let joints = first.joints_rad.len();
    let most = |order: usize, joint: usize| match order {
        1 => limits.speeds_rad_s[joint],
        2 => limits.acceleration_rad_s2,
        _ => limits.jerk_rad_s3,
    };
    for joint in 0..joints {
        assert!((first.joints_rad[joint] - from.joints_rad[joint]).abs() < 1e-9);
        for end in [first, last] {
            assert_eq!(end.speeds_rad_s[joint], 0.0);
            assert_eq!(end.accelerations_rad_s2[joint], 0.0);
        }
        // The joint rests before and after.
        let angle = |point: &Waypoint| point.joints_rad[joint];
        let mut values: Vec<f64> = vec![angle(first); 3];
        values.extend(waypoints.iter().map(angle));
        values.extend([angle(last); 3]);
        for order in 1..=3 {
            values = values
                .windows(2)
                .map(|pair| (pair[1] - pair[0]) / step_s)
                .collect();
            let found = values
                .iter()
                .fold(0.0f64, |most, value| most.max(value.abs()));
            // A difference of angles has sixteen digits, which matters after three divisions by a short step.
            let allowed = most(order, joint) * (1.0 + EXACT) + 1e-13 / step_s.powi(order as i32);
            assert!(
                found <= allowed,
                "joint {joint}, order {order}: {found} of {allowed}"
            );
        }
        for point in waypoints {
            assert!(point.speeds_rad_s[joint].abs() <= most(1, joint) * (1.0 + EXACT));
            assert!(point.accelerations_rad_s2[joint].abs() <= most(2, joint) * (1.0 + EXACT));
        }
    }
    let place = |joints_rad: &[f64]| -> Vector3<f64> {
        let tool = guard.chain().base_from_tool(joints_rad).unwrap();
        tool.translation.vector
    };
    let begin = from.tool.translation.vector;
    let way = motion.to.translation.vector - begin;
    for pair in waypoints.windows(2) {
        assert!((pair[1].at_s - pair[0].at_s - step_s).abs() < 1e-9 * last.at_s.max(1.0));
        let ends = [&pair[0], &pair[1]].map(|point| place(&point.joints_rad));
        let went_m = (ends[1] - ends[0]).norm();
        assert!(
            went_m <= (1.0 + TOOL) * motion.speed_m_s * step_s,
            "{went_m} m in {step_s} s"
        );
        assert!(went_m < (1.0 + TOOL) * crate::guard::STEP_M, "{went_m}");
        // As a controller interpolates.
        for part in 0..4 {
            let at_s = pair[0].at_s + f64::from(part) / 4.0 * step_s;
            let gone = place(&pair[0].towards(&pair[1], at_s)) - begin;
            let along = gone.dot(&way) / way.norm_squared();
            let beside_m = (gone - way * along.clamp(0.0, 1.0)).norm();
            assert!(beside_m < BESIDE_M, "{beside_m} m beside the line");
        }
    }
}

/// Walks a plan's motions, and compares the stated times with them; returns how many there are.
fn walked(settings: &Settings, points: [Point3<f64>; 2]) -> usize {
    let guard = guard(settings);
    let limits = JointLimits::of(settings, guard.chain());
    let Ok(rest) = ArmState::hand_down(settings, &settings.workspace.rest_m.into()) else {
        return 0;
    };
    let (plan, Some(route)) = Plan::make(settings, &guard, &rest, points, &Default::default())
    else {
        return 0;
    };
    let mut motions = 0;
    let mut walk =
        |from: ArmState, segments: &[Segment], planned: &[crate::plan::PlannedSegment]| {
            let mut at = from;
            let mut grasped = None;
            for (segment, planned) in segments.iter().zip(planned) {
                if let Act::Move(to) = segment.act {
                    let motion = guard.motion(&at, &to, settings.motion.speed_m_s).unwrap();
                    let motion = motion.get();
                    keeps_limits(&guard, &limits, &at, motion);
                    let takes_s = motion.takes_s();
                    assert!(
                        (planned.takes_s - takes_s).abs() < 1e-6,
                        "{planned:?}, {takes_s}"
                    );
                    for (joint, speed) in SPEEDS_DEG_S.iter().enumerate() {
                        let turned = planned.joints_deg[joint] - at.joints_rad[joint].to_degrees();
                        assert!(
                            turned.abs() <= speed * planned.takes_s + 1e-3,
                            "{planned:?}"
                        );
                    }
                    at.joints_rad
                        .clone_from(&motion.waypoints.last().unwrap().joints_rad);
                    at.tool = to;
                    motions += 1;
                }
                if segment.name == SegmentName::Grasp {
                    grasped = Some(at.clone());
                }
            }
            grasped
        };
    let grasped = walk(rest, &route.segments, &plan.segments);
    walk(
        grasped.unwrap(),
        &route.after_missed_grasp,
        &plan.after_missed_grasp,
    );
    motions
}

/// Walks plans of generated settings until so many are allowed.
fn walk_plans(plans: u64) {
    let mut chance = Chance::seeded(33);
    let (mut asked, mut allowed) = (0, 0);
    let drivers = ["simulated", "kinova", "trajectory"];
    while allowed < plans {
        assert!(asked < 20 * plans, "{allowed} of {asked}");
        asked += 1;
        let pick = |chance: &mut Chance, values: [f64; 4]| values[chance.below(4)];
        let motion = format!(
            "[motion]\nspeed_m_s = {}\nacceleration_deg_s2 = {}\njerk_deg_s3 = {}\n",
            pick(&mut chance, [0.02, 0.1, 0.1, 0.2]),
            pick(&mut chance, [20.0, 60.0, 60.0, 500.0]),
            pick(&mut chance, [200.0, 600.0, 600.0, 20_000.0]),
        );
        let driver = drivers[chance.below(drivers.len())];
        let ros = match driver {
            "simulated" => "",
            _ => "[ros]\nmaster = 'http://localhost:11311'\narm = '/arm'\ntrajectory = '/follow'\n",
        };
        let camera = match driver {
            "simulated" => "source = 'simulated'",
            _ => "source = 'directory', folder = 'pictures'",
        };
        let text = settings_text(&mut chance, 0.0)
            .replace("[motion]\n", &motion)
            .replace("driver = 'simulated'", &format!("driver = '{driver}'"))
            .replace("source = 'simulated'", camera);
        let Ok(settings) = Settings::parse(&(text + ros)) else {
            continue;
        };
        let height = [settings.table.center_m[2], 0.0, 0.0];
        let points = [0; 2].map(|_| target(&mut chance, height));
        allowed += u64::from(walked(&settings, points) > 0);
    }
}

#[test]
fn joints_keep_their_limits_and_the_tool_its_line_in_some_plans() {
    walk_plans(6);
}

#[test]
#[ignore = "long"]
fn joints_keep_their_limits_and_the_tool_its_line_in_many_plans() {
    walk_plans(80);
}

#[test]
fn the_simulated_arm_keeps_the_times_that_a_plan_states() {
    let settings = settings();
    for by in By::BOTH {
        let port = faulty(&settings, 0, &[], None);
        let mut arm = by.drive(Tapped::deaf(port, f64::INFINITY), &settings);
        let from = arm.state().unwrap();
        let points = [PICK_M, PLACE_M].map(Point3::from);
        let (plan, route) = Plan::make(
            &settings,
            &guard(&settings),
            &from,
            points,
            &Default::default(),
        );
        let route = route.unwrap();
        for (segment, planned) in route.segments.iter().zip(&plan.segments) {
            let Act::Move(to) = segment.act else { continue };
            arm.port().moved_s = None;
            go_to(&mut arm, &settings, &to, SPEED_M_S, &mut nobody).unwrap();
            // The node reports a goal as reached while the tool is on its last millimetres.
            arm.wait(1.0);
            let [first_s, last_s] = arm.port().moved_s.unwrap_or_default();
            let (moved_s, stated_s) = (last_s - first_s, planned.takes_s);
            assert!(
                (moved_s - stated_s).abs() <= KEPT * stated_s,
                "{by:?}, {}: {moved_s} s, and {stated_s} s were stated",
                segment.name.name()
            );
        }
    }
}

#[test]
fn a_trajectory_begins_where_the_joints_are_or_not_at_all() {
    let settings = settings();
    let there = tool_down(&Point3::new(0.40, -0.25, 0.20), 0.0);
    for (off_rad, is_sent) in [(0.0, true), (0.01, true), (0.06, false)] {
        let port = faulty(&settings, 0, &[], None);
        let tapped = Tapped {
            off_rad,
            ..Tapped::deaf(port, f64::INFINITY)
        };
        let mut arm = By::Trajectories.drive(tapped, &settings);
        let state = arm.state().unwrap();
        let motion = guard(&settings).motion(&state, &there, SPEED_M_S);
        assert_eq!(motion.is_ok(), is_sent, "{off_rad}");
        if let Ok(motion) = motion {
            assert_eq!(motion.get().waypoints[0].joints_rad, state.joints_rad);
        }
        let moved = go_to(&mut arm, &settings, &there, SPEED_M_S, &mut nobody);
        match is_sent {
            true => drop(moved.unwrap()),
            false => {
                let Err(ArmError::Refused(why)) = moved else {
                    panic!("{moved:?}");
                };
                assert!(why.contains("the readings do not fit"), "{why}");
                assert!(arm.port().moved_s.is_none());
            }
        }
    }
}

#[test]
fn a_hand_that_is_turned_against_the_model_is_refused() {
    let settings = settings();
    let mut arm = By::Trajectories.drive(faulty(&settings, 0, &[], None), &settings);
    let mut state = arm.state().unwrap();
    let there = tool_down(&Point3::new(0.40, -0.25, 0.20), 0.0);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2);
    state.tool *= turn;
    let motion = guard(&settings).motion(&state, &(there * turn), SPEED_M_S);
    let why = motion.map(drop).unwrap_err();
    assert!(why.contains("and 90.0 degrees away"), "{why}");
}

#[test]
fn a_motion_that_would_take_too_long_is_refused() {
    let settings = settings();
    let limits = JointLimits::of(&settings, guard(&settings).chain());
    let path: Vec<Vec<f64>> = (0..=200)
        .map(|step| vec![0.001 * f64::from(step); 6])
        .collect();
    let timed = limits.time(&path, 2.0, 0.005).unwrap();
    assert!((400.0..402.0).contains(&timed.last().unwrap().at_s));
    for speed_m_s in [0.003, 1e-9] {
        let why = limits.time(&path, 2.0, speed_m_s).map(drop).unwrap_err();
        assert!(why.contains("at most 600 s are allowed"), "{why}");
    }
    // No motion takes no time, and no numbers are no motion.
    assert_eq!(limits.time(&path[..1], 0.0, 0.1).unwrap().len(), 1);
    assert_eq!(
        limits
            .time(&[path[0].clone(), path[0].clone()], 0.0, 0.1)
            .unwrap()
            .len(),
        1
    );
    assert!(
        limits
            .time(&[vec![0.0; 6], vec![f64::NAN; 6]], 0.1, 0.1)
            .is_err()
    );
}
