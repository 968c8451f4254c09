//! Tests of the reach of a hand pointing down, and of refusal messages.

use super::*;
use crate::kinematics::reach::Reach;
use crate::kinematics::tool_down::tool_down;
use nalgebra::Point3;

fn at(radius_m: f64, azimuth_rad: f64, height_m: f64) -> Point3<f64> {
    Point3::new(
        radius_m * azimuth_rad.cos(),
        radius_m * azimuth_rad.sin(),
        height_m,
    )
}

#[test]
fn each_model_reaches_its_ring_of_the_table() {
    for (model, nearest_m, farthest_m) in [
        ("j2n6s200", 0.18, 0.70),
        ("j2n6s300", 0.18, 0.70),
        ("j2s6s200", 0.16, 0.72),
    ] {
        let range = Reach::tool_down(&chain_of(model), 0.0).range(0.0).unwrap();
        assert!(
            (range.nearest_m - nearest_m).abs() < 0.001,
            "{model}: {range:?}"
        );
        assert!(
            (range.farthest_m - farthest_m).abs() < 0.001,
            "{model}: {range:?}"
        );
    }
}

/// The vendor's own joint limits determine the ring; link lengths are only an upper bound.
#[test]
#[ignore = "long"]
fn no_farther_than_the_links_are_long() {
    for model in MODELS {
        let reach = Reach::tool_down(&chain_of(model), 0.0);
        for height_cm in (-60..120).step_by(5) {
            let height_m = f64::from(height_cm) / 100.0;
            let Some(range) = reach.range(height_m) else {
                continue;
            };
            // D2 + D3 + the wrist in one line from the shoulder to 0.16 m above the tool.
            let wrist_m = 0.410 + 0.2073 + 0.2075;
            let down_m = 0.2755 - (height_m + 0.160);
            assert!(
                range.farthest_m.hypot(down_m) < wrist_m + 0.02,
                "{model} at {height_m}: {range:?}"
            );
            assert!(range.nearest_m <= range.farthest_m);
        }
        assert_eq!(reach.range(1.5), None);
        assert_eq!(reach.range(f64::NAN), None);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    #[ignore = "long"]
    fn within_the_range_is_reached_and_beyond_it_is_not(
        model in prop::sample::select(MODELS.to_vec()),
        (part, azimuth, height_steps, turn) in (0.0..1.0f64, -4.0..4.0f64, -10..40i32, -7.0..7.0f64),
    ) {
        let chain = chain_of(model);
        let reach = Reach::tool_down(&chain, turn);
        let height_m = f64::from(height_steps) * 0.005;
        let range = reach.range(height_m).unwrap();
        let (least, most) = (range.nearest_m, range.farthest_m);
        let point = at(least + part * (most - least), azimuth, height_m);
        let joints = match reach.check(&point, &[]) {
            Ok(joints) => joints,
            Err(refused) => {
                prop_assert!(refused.ends_with("but not there") && point.x.hypot(point.y) < 0.2, "{}", refused);
                return Ok(());
            }
        };
        let tool = chain.base_from_tool(&joints).unwrap();
        let wanted = tool_down(&point, turn);
        prop_assert!(distance_m(&tool, &wanted) < 1e-4);
        prop_assert!(angle_deg(&tool, &wanted) < 0.01);
        prop_assert!(chain.is_within_limits(&joints));
        prop_assert!(chain.frames(&joints).unwrap()[2].translation.z > height_m + 0.049);
        let refused = reach.check(&at(range.farthest_m + 0.011 + part, azimuth, height_m), &[]).unwrap_err();
        prop_assert!(!refused.contains("but not"), "{}", refused);
        let near_m = (range.nearest_m - 0.011) * (1.0 - part * part);
        if let Err(refused) = reach.check(&at(near_m, azimuth, height_m), &[]) {
            prop_assert!(!refused.contains("but not"), "{}", refused);
        }
    }

    #[test]
    #[ignore = "long"]
    fn what_is_reached_with_more_heights_is_reached_with_fewer(
        model in prop::sample::select(MODELS.to_vec()),
        (radius, azimuth) in (0.12..0.75f64, -4.0..4.0f64),
        heights in prop::collection::vec(0.0..0.5f64, 0..5),
    ) {
        let reach = Reach::tool_down(&chain_of(model), 0.0);
        let point = at(radius, azimuth, 0.01);
        let all = reach.check(&point, &heights);
        let few = reach.check(&point, &heights[..heights.len() / 2]);
        prop_assert!(all.is_err() || few.is_ok());
        // A path up also passes the heights in between.
        let top = heights.iter().copied().fold(0.0, f64::max);
        prop_assert_eq!(all.is_ok(), reach.check(&point, &[top]).is_ok());
        prop_assert_eq!(all.is_ok(), reach.check(&at(radius, azimuth + 1.0, 0.01), &heights).is_ok());
    }

    #[test]
    fn any_point_gets_an_answer(
        place in prop::array::uniform3(prop_oneof![Just(f64::NAN), Just(f64::NEG_INFINITY), Just(1e300), Just(0.0), -11.0..11.0f64]),
        heights in prop::collection::vec(prop_oneof![Just(f64::NAN), Just(-0.1), Just(1e300), 0.0..11.0f64], 0..4),
    ) {
        let reach = Reach::tool_down(&chain_of("j2n6s300"), 0.0);
        if let Err(refused) = reach.check(&place.into(), &heights) {
            prop_assert!(!refused.is_empty());
        }
    }
}

#[test]
fn a_refusal_says_how_far_and_what_is_reached() {
    let reach = Reach::tool_down(&chain_of("j2n6s200"), 0.0);
    let said = |point: Point3<f64>, heights: &[f64]| reach.check(&point, heights).unwrap_err();
    let far = said(at(0.82, 1.0, 0.0), &[0.005, 0.1]);
    assert_eq!(
        far,
        "0.82 m from the arm's base; at this height it reaches 0.18 to 0.70 m"
    );
    let near = said(at(0.12, 1.0, 0.0), &[]);
    assert_eq!(
        near,
        "0.12 m from the arm's base; at this height it reaches 0.18 to 0.70 m"
    );
    let above = said(at(0.69, 1.0, 0.0), &[0.005, 0.3]);
    assert_eq!(
        above,
        "0.69 m from the arm's base; at this height it reaches 0.18 to 0.70 m, but not straight up from there"
    );
    let never = said(at(0.3, 1.0, 1.3), &[]);
    assert_eq!(
        never,
        "0.30 m from the arm's base; at this height it reaches nothing"
    );
    let nowhere = said(Point3::new(f64::NAN, 0.0, 0.0), &[]);
    assert_eq!(
        nowhere,
        "the point or a height above it is not within 10 m of the arm's base"
    );
}

#[test]
fn the_elbow_does_not_go_below_the_point() {
    // There this arm has only one posture, with the elbow under the hand.
    let chain = chain_of("j2s6s200");
    let point = at(0.405, 0.0, 0.6);
    assert!(chain.solve(&tool_down(&point, 0.0), &HOME_RAD).is_ok());
    let refused = Reach::tool_down(&chain, 0.0)
        .check(&point, &[])
        .unwrap_err();
    assert!(!refused.contains("but not"), "{refused}");
}
