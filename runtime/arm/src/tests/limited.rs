//! Tests that motions permitted by the limits stay within them.

use super::*;
use crate::driver::{ArmError, Opening};
use crate::kinematics::tool_down::tool_down;
use crate::limits::check;
use crate::settings::{KeepOut, Workspace};
use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

const MARGIN_M: f64 = 0.003;

fn workspace() -> Workspace {
    let keep_out = [
        ("lamp", [0.55, 0.10, 0.0], [0.65, 0.20, 0.30]),
        ("wire", [0.30, -0.20, 0.18], [0.70, -0.199, 0.182]),
    ];
    Workspace {
        keep_out: keep_out
            .map(|(name, min_m, max_m)| KeepOut {
                name: name.to_owned(),
                min_m,
                max_m,
            })
            .into(),
        ..settings().workspace
    }
}

/// A coordinate, sometimes outside every box and sometimes NaN or infinite.
fn coordinate(least: f64, most: f64) -> impl Strategy<Value = f64> {
    let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 0.0];
    prop_oneof![
        40 => least - 0.02..most + 0.02,
        1 => proptest::sample::select(odd.to_vec()),
    ]
}

fn point() -> impl Strategy<Value = Point3<f64>> {
    (
        coordinate(0.15, 0.75),
        coordinate(-0.525, 0.525),
        coordinate(0.01, 0.45),
    )
        .prop_map(|(x, y, z)| Point3::new(x, y, z))
}

fn is_within(point: &Vector3<f64>, min_m: &[f64; 3], max_m: &[f64; 3]) -> bool {
    (0..3).all(|axis| (min_m[axis]..=max_m[axis]).contains(&point[axis]))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    #[ignore = "long"]
    fn ways_that_pass_stay_in_the_box_and_out_of_the_zones(
        from in point(),
        to in point(),
        tilt_rad in -0.4_f64..0.4,
        speed_m_s in prop_oneof![9 => 0.0_f64..0.3, 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)],
        max_step_m in 0.1_f64..1.0,
    ) {
        let workspace = Workspace { max_step_m, ..workspace() };
        let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), tilt_rad);
        let (start, mut end) = (tool_down(&from, 0.0), tool_down(&to, 0.0));
        end.rotation = tilt * end.rotation;
        if check(&workspace, MARGIN_M, &start, &end, speed_m_s).is_ok() {
            prop_assert!(speed_m_s > 0.0 && speed_m_s <= workspace.max_speed_m_s);
            prop_assert!((to - from).norm() <= max_step_m);
            prop_assert!(tilt_rad.abs() <= 0.2 + 1e-9);
            let margin = |value: [f64; 3], sign: f64| value.map(|value| value + sign * MARGIN_M);
            let (least, most) = (margin(workspace.min_m, 1.0), margin(workspace.max_m, -1.0));
            prop_assert!(is_within(&to.coords, &least, &most));
            for part in 0..=400 {
                let at = from.coords.lerp(&to.coords, f64::from(part) / 400.0);
                prop_assert!(is_within(&at, &workspace.min_m, &workspace.max_m), "{}", at);
                for zone in &workspace.keep_out {
                    prop_assert!(!is_within(&at, &zone.min_m, &zone.max_m), "{} in {}", at, zone.name);
                }
            }
        }
    }

    /// A check that refused everything would pass the law above.
    #[test]
    #[ignore = "long"]
    fn ways_well_within_pass(
        from in (0.2_f64..0.5, 0.25_f64..0.5, 0.05_f64..0.4),
        to in (0.2_f64..0.5, 0.25_f64..0.5, 0.05_f64..0.4),
    ) {
        let [from, to] = [from, to].map(|(x, y, z)| tool_down(&Point3::new(x, y, z), 0.3));
        prop_assert_eq!(check(&workspace(), MARGIN_M, &from, &to, 0.1), Ok(()));
    }
}

/// A tool that came to rest inside a zone's margin must not be trapped there.
#[test]
fn a_tool_within_the_margin_of_a_zone_may_go_away_from_it() {
    let allowed = |from: [f64; 3], to: [f64; 3]| {
        let [from, to] = [from, to].map(|point| tool_down(&point.into(), 0.0));
        check(&workspace(), MARGIN_M, &from, &to, 0.1).is_ok()
    };
    let beside = [0.55 - 0.001, 0.15, 0.10];
    assert!(allowed(beside, [0.40, 0.15, 0.10]));
    // Straight up along its side, as a pick and place begins.
    assert!(allowed(beside, [beside[0], 0.15, 0.35]));
    for to in [
        [0.55 - 0.002, 0.15, 0.10], // still within the margin
        [0.549, 0.19, 0.10],        // along the zone, and still within the margin
        [0.60, 0.15, 0.40],         // over its corner
        [0.75 - 0.01, 0.15, 0.10],  // through it
        [0.56, 0.30, 0.10],         // nearer at first
    ] {
        assert!(!allowed(beside, to), "{to:?}");
    }
    let within = [0.55 + 0.001, 0.15, 0.10];
    assert!(!allowed(within, [0.40, 0.15, 0.10]));
}

#[test]
fn a_pose_that_is_none_is_refused() {
    let here = tool_down(&Point3::new(0.4, 0.3, 0.2), 0.0);
    for broken in [
        Quaternion::new(f64::NAN, 0.0, 0.0, 0.0),
        Quaternion::new(0.0, 1.0, f64::NAN, 0.0),
        Quaternion::new(f64::INFINITY, 0.0, 0.0, 0.0),
        Quaternion::new(0.0, 0.0, 0.0, 0.0),
    ] {
        let mut to = here;
        to.rotation = UnitQuaternion::new_unchecked(broken);
        assert!(
            check(&workspace(), MARGIN_M, &here, &to, 0.1).is_err(),
            "{broken}"
        );
    }
    for axis in 0..3 {
        let mut to = here;
        to.translation = Translation3::from(here.translation.vector);
        to.translation.vector[axis] = f64::NAN;
        assert!(check(&workspace(), MARGIN_M, &here, &to, 0.1).is_err());
        assert!(check(&workspace(), MARGIN_M, &to, &here, 0.1).is_err());
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
    bench.arm.stop().unwrap();
    bench.stays_stopped();
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
