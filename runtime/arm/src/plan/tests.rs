//! Tests of `plan.rs`.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::guard::Surface;
use crate::kinematics::chain::Chain;

const ROBOT: &str = "
name = 'lab'
model = 'j2n6s200'
driver = 'simulated'
calibration = 'lab.calibration.toml'
table = { center_m = [0.45, 0.0, 0.02] }
fingers = { count = 2, open = 0.0, closed = 6400.0, tolerance = 100.0 }
camera = { source = 'simulated', window_px = [0, 0, 720] }
[workspace]
min_m = [0.15, -0.525, 0.01]
max_m = [0.75, 0.525, 0.45]
rest_m = [0.35, -0.35, 0.25]
keep_out = [{ name = 'lamp', min_m = [0.45, 0.25, 0.0], max_m = [0.5, 0.35, 0.4] }]
";

fn plan(pick_m: [f64; 3], place_m: [f64; 3]) -> (Plan, Chain) {
    plan_of(ROBOT, [pick_m, place_m])
}

fn plan_of(robot: &str, points_m: [[f64; 3]; 2]) -> (Plan, Chain) {
    let settings = Settings::parse(robot).unwrap();
    let chain = Chain::of_model("j2n6s200").unwrap();
    let guard = Guard::new(&settings, Surface::level(&settings));
    let from = ArmState::hand_down(&settings, &settings.workspace.rest_m.into()).unwrap();
    let points = points_m.map(Point3::from);
    let (plan, route) = Plan::make(&settings, &guard, &from, points, &Manner::default());
    assert_eq!(route.is_some(), plan.refused.is_none());
    (plan, chain)
}

#[test]
fn joints_at_the_end_of_a_segment_bring_the_tool_there() {
    let (plan, chain) = plan([0.40, 0.05, 0.02], [0.52, -0.12, 0.02]);
    assert_eq!(plan.refusal(), None);
    for segment in &plan.segments {
        let joints: Vec<f64> = segment
            .joints_deg
            .iter()
            .map(|it| it.to_radians())
            .collect();
        let tool = chain.base_from_tool(&joints).unwrap();
        let off = tool.translation.vector - Point3::from(segment.to_m).coords;
        assert!(off.norm() < 1e-5, "{segment:?}");
    }
    // Joints speed up and slow down in each of eight motions.
    let (least_s, takes_s) = (plan.way_m() / 0.10, plan.takes_s());
    assert!(
        takes_s > least_s + 2.0 && takes_s < 2.0 * least_s,
        "{takes_s}"
    );
    let last = plan.segments.last().unwrap();
    assert_eq!(
        (last.name, last.to_m),
        (SegmentName::Rest, [0.35, -0.35, 0.25])
    );
}

/// A missed grasp leads straight up from the pick, which no other segment does.
#[test]
fn the_way_home_after_a_missed_grasp_is_planned_too() {
    let (plan, _) = plan([0.40, 0.05, 0.02], [0.52, -0.12, 0.02]);
    let home = &plan.after_missed_grasp;
    let names: Vec<&str> = home.iter().map(|segment| segment.name.name()).collect();
    assert_eq!(names, ["up", "release", "away", "rest"]);
    assert_eq!(home[0].to_m, [0.40, 0.05, 0.07]);
    assert!((home[0].way_m - 0.05).abs() < 1e-9);
    assert!(home.iter().all(|segment| segment.joints_deg.len() == 6));
}

/// Above a high pick the hand would leave the box, and above the place it would not.
#[test]
fn a_way_home_that_is_not_allowed_refuses_the_plan() {
    let robot = ROBOT.replace("0.525, 0.45]", "0.525, 0.26]")
        + "[motion]\nretreat_m = 0.2\ntravel_m = 0.2\n";
    let points = [[0.40, 0.05, 0.07], [0.52, -0.12, 0.02]];
    let (plan, _) = plan_of(&robot, points);
    let refusal = plan.refusal().unwrap_or_default();
    let expected = "`up`, after a missed grasp, is not possible: the tool would be at";
    assert!(refusal.starts_with(expected), "{refusal}");
    assert_eq!(plan.segments.last().unwrap().name, SegmentName::Rest);
}

#[test]
fn a_plan_ends_with_the_segment_that_is_refused() {
    for (pick_m, place_m, name, why) in [
        ([0.27, 0.30, 0.02], [0.62, 0.30, 0.02], "over", "`lamp`"),
        ([0.40, 0.05, 0.02], [0.45, 0.60, 0.02], "over", "workspace"),
        (
            [0.72, 0.20, 0.02],
            [0.45, 0.0, 0.02],
            "over_pick",
            "the arm cannot follow",
        ),
    ] {
        let (plan, _) = plan(pick_m, place_m);
        let refusal = plan.refusal().unwrap_or_default();
        assert!(refusal.contains(why), "{refusal}");
        assert_eq!(plan.segments.last().unwrap().name.name(), name, "{refusal}");
    }
}
