//! Tests of `reach.rs`.

#![allow(clippy::unwrap_used)]
use super::*;
use crate::world::Files;
use fab_program::Manner;
use std::path::Path;

/// Cloth on the low side of a tilted table is grasped where it lies, not at the height of the table's middle.
#[test]
fn grasp_heights_follow_a_tilted_table() {
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tasks/real/simulated.toml");
    let settings = Files::load(&robot).unwrap().settings;
    let slope = 3f64.to_radians().tan();
    let [x, y, z] = settings.table.center_m;
    let world_from_base = base_from_world(&settings).inverse();
    for way_rad in (0..10).map(f64::from) {
        let [along_x, along_y] = [slope * way_rad.cos(), slope * way_rad.sin()];
        let surface = Surface::tilted([z - along_x * x - along_y * y, along_x, along_y]);
        for (at_x, at_y) in [(0.3, -0.2), (0.3, 0.2), (0.6, -0.2), (0.6, 0.2), (x, y)] {
            let cloth = Point3::new(at_x, at_y, surface.height_m(at_x, at_y));
            let pick = base_point(&settings, &surface, &(world_from_base * cloth));
            assert!((pick - cloth).norm() < 1e-9, "{pick} {cloth}");
            // What a camera sees below the table lies on it.
            let below = cloth - nalgebra::Vector3::z() * 0.03;
            let pick = base_point(&settings, &surface, &(world_from_base * below));
            assert!((pick - cloth).norm() < 1e-9, "{pick} {cloth}");
            let rest = tool_down(&settings.workspace.rest_m.into(), 0.0);
            let route =
                route::Route::new(&settings, &surface, &rest, &pick, &pick, &Manner::default());
            let is_down = |it: &&route::Segment| it.name == route::SegmentName::Down;
            let down = route.segments.iter().find(is_down).unwrap();
            let route::Act::Move(to) = down.act else {
                panic!("{down:?}")
            };
            assert!((to.translation.z - cloth.z).abs() < 1e-9);
        }
    }
}

/// A point at the rim can be reached in one posture only: an arm that is off by a millimetre does not get there.
#[test]
fn points_at_the_rim_are_left_out_by_what_an_arm_may_be_off() {
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tasks/real/simulated.toml");
    let Files {
        settings,
        calibration,
        ..
    } = Files::load(&robot).unwrap();
    let guard = guard(&settings, &calibration);
    let reach = ArmReach::new(&settings, guard);
    let world_from_base = base_from_world(&settings).inverse();
    let angle_rad = 0.215_f64;
    let at = |radius_m: f64| {
        let (sin, cos) = angle_rad.sin_cos();
        let base = Point3::new(radius_m * cos, radius_m * sin, 0.02);
        reach.out_of_reach(&settings, &(world_from_base * base))
    };
    assert_eq!(at(0.70), None);
    let why = at(0.7072).unwrap();
    assert!(why.contains("it lies 0.71 m from the arm's base"), "{why}");
    assert!(at(0.187).is_some(), "the same holds near the base");
    let why = at(0.19).unwrap();
    assert!(
        why.contains("the arm behind joint 2 would be within"),
        "{why}"
    );
    let nearest = (19..30).find(|cm| at(f64::from(*cm) / 100.0).is_none());
    assert_eq!(nearest, Some(21), "no part of the arm touches another");
    // By its kinematics alone, the arm would reach both.
    for radius_m in [0.7072, 0.187] {
        let base = Point3::new(radius_m * angle_rad.cos(), radius_m * angle_rad.sin(), 0.02);
        assert!(
            reach.reach.check(&base, &[0.05, 0.10]).is_ok(),
            "{radius_m}"
        );
    }
}

#[test]
fn manners_beyond_the_arm_are_refused_by_name_and_with_the_bound() {
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tasks/real/simulated.toml");
    let Files {
        mut settings,
        calibration,
        ..
    } = Files::load(&robot).unwrap();
    let reach = ArmReach::new(&settings, guard(&settings, &calibration));
    let points = [
        WorldPoint::new(-0.05, 0.0, 0.0),
        WorldPoint::new(0.1, 0.05, 0.0),
    ];
    let motion = |manner: Manner| Motion::from(Grip::new(points[0], points[1]).with_manner(manner));
    let said = |settings: &Settings, name: &str, value: f64| {
        reach.refuses(settings, &motion(Manner::default().with(name, value)))
    };
    for (name, value) in [
        ("lift", 0.0),
        ("lift", 0.1),
        ("release_height", 0.0),
        ("release_height", 0.1),
        ("press", 0.0),
        ("speed", settings.motion.speed_m_s),
        ("speed", 0.03),
    ] {
        assert_eq!(said(&settings, name, value), None, "{name} {value}");
    }
    let top_m = settings.workspace.max_m[2];
    let usual_m_s = settings.motion.speed_m_s;
    for (name, value, expected) in [
        (
            "lift",
            0.9,
            "`lift` of 900 mm is not possible: the tool would be at".to_owned(),
        ),
        ("lift", 0.9, format!("to {top_m:.3} m")),
        (
            "release_height",
            0.9,
            "`release_height` of 900 mm is not possible".to_owned(),
        ),
        (
            "press",
            0.1,
            "`press` is not possible: the arm feels no force".to_owned(),
        ),
    ] {
        let why = said(&settings, name, value).unwrap();
        assert!(why.contains(&expected), "{why}");
    }
    // An arm that takes poses alone has one speed.
    settings.driver = DriverKind::Kinova;
    assert_eq!(said(&settings, "speed", usual_m_s), None);
    let why = said(&settings, "speed", 0.03).unwrap();
    let expected = format!("a speed of its own, `motion.speed_m_s` of {usual_m_s} m/s");
    assert!(why.contains(&expected), "{why}");
    // An arm that follows trajectories takes a speed, within its limits.
    settings.driver = DriverKind::Trajectory;
    assert_eq!(said(&settings, "speed", 0.03), None);
    let most_m_s = settings.workspace.max_speed_m_s;
    let why = said(&settings, "speed", most_m_s + 0.1).unwrap();
    let expected = format!("`workspace.max_speed_m_s` of {most_m_s} m/s");
    assert!(why.contains(&expected), "{why}");
}
