//! Laws of the made-up arm: its shapes contain those of its URDF, and it goes where it is sent.

use super::*;
use crate::description::hull;
use crate::driver::ArmState;
use crate::guard::Guard;
use crate::kinematics::reach::Reach;
use crate::kinematics::tool_down::tool_down;
use crate::plan::Plan;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::LazyLock;

static SEVEN: LazyLock<Settings> = LazyLock::new(seven);

fn within_limits() -> impl Strategy<Value = Vec<f64>> {
    let joints = SEVEN.chain().joints().iter();
    let ranges = joints.map(|joint| joint.limits_rad.unwrap_or([-PI, PI]));
    ranges.map(|[least, most]| least..=most).collect::<Vec<_>>()
}

/// Where the tool is, by the lengths and axes that the URDF states, multiplied out by hand.
fn tool_by_hand(angles: &[f64]) -> Isometry3<f64> {
    let up = |z: f64| Isometry3::translation(0.0, 0.0, z);
    let about = |axis: Vector3<f64>, angle: f64| {
        let turn = UnitQuaternion::from_scaled_axis(axis * angle);
        Isometry3::from_parts(nalgebra::Translation3::identity(), turn)
    };
    let (y, z) = (Vector3::y(), Vector3::z());
    let upper = up(0.3) * about(z, angles[0]) * about(y, angles[1]) * up(0.2) * about(z, angles[2]);
    let fore = up(0.2) * about(-y, angles[3]) * up(0.2) * about(z, angles[4]);
    upper * fore * up(0.19) * about(y, angles[5]) * up(0.08) * about(z, angles[6]) * up(0.05 + 0.09)
}

fn distance_m(one: &Isometry3<f64>, other: &Isometry3<f64>) -> f64 {
    (one.translation.vector - other.translation.vector).norm()
}

/// Returns how far a point is outside of a capsule, metres.
fn outside_m(point: &Point3<f64>, (from, to, radius_m): hull::Ends) -> f64 {
    let along = to - from;
    let share = ((point - from).dot(&along) / along.norm_squared().max(1e-18)).clamp(0.0, 1.0);
    (point - from - along * share).norm() - radius_m
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_tool_is_where_the_urdf_says(angles in within_limits()) {
        let tool = SEVEN.chain().base_from_tool(&angles).unwrap();
        let by_hand = tool_by_hand(&angles);
        prop_assert!(distance_m(&tool, &by_hand) < 1e-6, "{tool} {by_hand}");
        prop_assert!(tool.rotation.angle_to(&by_hand.rotation) < 1e-6);
    }

    #[test]
    fn a_pose_of_seven_joints_is_found_from_another(angles in within_limits(), near in within_limits()) {
        let chain = SEVEN.chain();
        let pose = chain.base_from_tool(&angles).unwrap();
        let found = chain.solve(&pose, &near).unwrap();
        prop_assert_eq!(found.len(), 7);
        let reached = chain.base_from_tool(&found).unwrap();
        prop_assert!(distance_m(&reached, &pose) <= 1e-4);
        prop_assert!(reached.rotation.angle_to(&pose.rotation) <= 0.01f64.to_radians());
        prop_assert!(chain.is_within_limits(&found));
    }

    #[test]
    fn a_capsule_contains_its_points(
        points in prop::collection::vec(prop::array::uniform3(-0.3..0.3f64), 1..40),
        radius_m in 0.0..0.1f64,
    ) {
        let points: Vec<Point3<f64>> = points.into_iter().map(Point3::from).collect();
        let capsule = hull::capsule(&points, radius_m).unwrap();
        for point in &points {
            prop_assert!(outside_m(point, capsule) + radius_m <= 0.0);
        }
        let farthest_m = points.iter().map(|it| it.coords.norm()).fold(0.0, f64::max);
        prop_assert!(capsule.2 <= 2.0 * farthest_m + radius_m + 1e-6, "it is not larger than the points need");
    }

    /// The corners of hand and fingers, closed and open, by the sizes in the URDF.
    #[test]
    fn the_hand_contains_its_fingers_in_every_opening(
        corner in prop::array::uniform3(prop_oneof![Just(-1.0), Just(1.0)]),
        slide in -0.04..0.04f64,
    ) {
        let [x, y, z] = corner;
        let palm = Point3::new(0.02 * x, 0.08 * y, 0.025 * z - 0.09);
        let finger = Point3::new(0.0075 * x, 0.005 * y + slide, 0.035 * z - 0.03);
        for point in [palm, finger] {
            let hand = SEVEN.chain().shapes().iter().filter(|shape| shape.link == 7);
            let outside = hand.map(|it| outside_m(&point, (it.ends[0], it.ends[1], it.radius_m)));
            let outside_m = outside.fold(f64::INFINITY, f64::min);
            prop_assert!(outside_m <= 1e-6, "{point} is {outside_m} m outside");
        }
    }

    #[test]
    fn a_straight_way_of_seven_joints_stays_on_its_line(
        (radius, azimuth, height) in (0.4..0.6f64, -0.6..0.6f64, 0.03..0.2f64),
    ) {
        let chain = SEVEN.chain();
        let from = Point3::new(0.45, 0.0, 0.1);
        let to = Point3::new(radius * azimuth.cos(), radius * azimuth.sin(), height);
        let start = Reach::tool_down(chain, 0.0).check(&from, &[]).unwrap();
        let [from, to] = [from, to].map(|point| tool_down(&point, 0.0));
        let way = chain.straight(&start, &to, 0.01).unwrap();
        let along = to.translation.vector - from.translation.vector;
        for joints in &way {
            let tool = chain.base_from_tool(joints).unwrap();
            let gone = tool.translation.vector - from.translation.vector;
            let beside = gone - along * (gone.dot(&along) / along.norm_squared().max(1e-12));
            prop_assert!(beside.norm() < 2e-4 || along.norm() < 1e-3, "{}", beside.norm());
            prop_assert!(chain.is_within_limits(joints));
        }
    }
}

#[test]
fn what_is_out_of_reach_is_named_with_distance_and_reach() {
    let chain = SEVEN.chain();
    let reach = Reach::tool_down(chain, 0.0);
    let why = reach.check(&Point3::new(0.9, 0.0, 0.0), &[]).unwrap_err();
    assert!(
        why.starts_with("0.90 m from the arm's base; at this height it reaches"),
        "{why}"
    );
}

#[test]
fn of_several_postures_the_one_near_home_is_taken() {
    let home = [0.0, 35.0, 0.0, -90.0, 0.0, 55.0, 0.0].map(f64::to_radians);
    let chain = SEVEN.chain();
    let at_home = chain.base_from_tool(&home).unwrap();
    let turn_rad = {
        let x = at_home.rotation * Vector3::x();
        x.y.atan2(x.x)
    };
    let reach = Reach::tool_down(chain, turn_rad);
    let found = reach
        .check(&Point3::from(at_home.translation.vector), &[0.05])
        .unwrap();
    for (found, home) in found.iter().zip(home) {
        assert!((found - home).abs() < 0.01, "{found} {home}");
    }
}

#[test]
fn a_plan_of_the_made_up_arm_is_allowed_and_one_below_the_table_is_not() {
    let guard = Guard::level(&SEVEN);
    let from = ArmState::hand_down(&SEVEN, &SEVEN.workspace.rest_m.into()).unwrap();
    let plan = |height_m: f64| {
        let points = [[0.55, 0.15, height_m], [0.35, -0.15, height_m]].map(Point3::from);
        Plan::make(&SEVEN, &guard, &from, points, &Default::default())
            .0
            .refusal()
    };
    assert_eq!(plan(0.02), None);
    let why = plan(0.0).unwrap();
    assert!(
        why.contains("below the table") || why.contains("workspace"),
        "{why}"
    );
}
