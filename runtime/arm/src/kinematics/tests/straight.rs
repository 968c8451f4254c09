//! Tests of straight paths: on the line, smooth, and refused if the posture cannot be kept.

use super::*;
use crate::kinematics::reach::Reach;
use crate::kinematics::straight::MAX_JUMP_RAD;
use crate::kinematics::tool_down::tool_down;
use nalgebra::Point3;

/// Two points above the table that every model reaches pointing down, with rotations; except where the bent wrist's
/// forearm becomes vertical.
fn two_poses() -> impl Strategy<Value = [Isometry3<f64>; 2]> {
    let pose = || {
        (0.36..0.62f64, -0.9..0.9f64, 0.0..0.15f64, -0.7..0.7f64).prop_map(
            |(radius, azimuth, height, turn)| {
                tool_down(
                    &Point3::new(radius * azimuth.cos(), radius * azimuth.sin(), height),
                    turn,
                )
            },
        )
    };
    [pose(), pose()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    #[ignore = "long"]
    fn the_tool_stays_on_the_line_and_the_joints_move_smoothly(
        model in prop::sample::select(MODELS.to_vec()),
        [from, to] in two_poses(),
    ) {
        let chain = chain_of(model);
        let reach = Reach::tool_down(&chain, 0.0);
        let start = reach.check(&Point3::from(from.translation.vector), &[]).unwrap();
        let start = chain.solve(&from, &start).unwrap();
        let way = chain.straight(&start, &to, 0.01).unwrap();
        let along = to.translation.vector - from.translation.vector;
        prop_assert!(way.len() > (along.norm() / 0.01).ceil() as usize);
        prop_assert!(distance_m(&chain.base_from_tool(&way[0]).unwrap(), &from) < 1e-4);
        prop_assert!(distance_m(&chain.base_from_tool(&way[way.len() - 1]).unwrap(), &to) < 1e-4);
        let mut before = 0.0;
        for pair in way.windows(2) {
            let turned = pair[0].iter().zip(&pair[1]).map(|(one, other)| (other - one).abs()).fold(0.0, f64::max);
            prop_assert!(turned < MAX_JUMP_RAD / 2.0, "{} rad in a step", turned);
            for quarter in 0..4 {
                let part = f64::from(quarter) / 4.0;
                let joints: Vec<f64> = pair[0].iter().zip(&pair[1]).map(|(one, other)| one + part * (other - one)).collect();
                let tool = chain.base_from_tool(&joints).unwrap();
                let gone = tool.translation.vector - from.translation.vector;
                let beside_m = (gone - along * (gone.dot(&along) / along.norm_squared())).norm();
                prop_assert!(beside_m < 3e-4, "{} m beside the line", beside_m);
                prop_assert!((tool.rotation * nalgebra::Vector3::z()).z < -0.9999);
                let forward = gone.dot(&along);
                prop_assert!(forward >= before - 1e-6);
                before = forward;
            }
        }
    }
}

#[test]
fn a_way_that_leaves_the_reach_says_where() {
    let chain = chain_of("j2n6s200");
    let [from, to] = [0.60, 0.80].map(|x| tool_down(&Point3::new(x, 0.0, 0.0), 0.0));
    let start = chain.solve(&from, &HOME_RAD).unwrap();
    let why = chain.straight(&start, &to, 0.01).unwrap_err();
    let after_m: f64 = why.split('`').nth(1).unwrap().parse().unwrap();
    assert!((0.09..0.12).contains(&after_m), "{why}");
}

#[test]
fn a_jump_to_another_posture_is_refused() {
    // Through the base's axis the first joint would have to turn by half a turn at once.
    let chain = chain_of("j2s6s200");
    let [from, to] = [0.2, -0.2].map(|x| tool_down(&Point3::new(x, 0.012, 0.25), 0.0));
    let start = chain.solve(&from, &HOME_RAD).unwrap();
    let error = chain.straight(&start, &to, 0.05).unwrap_err();
    assert!(error.contains("along the straight path"), "{error}");
}

#[test]
fn steps_that_are_none_are_refused() {
    let chain = chain_of("j2n6s200");
    let [from, to] = [0.4, 0.5].map(|x| tool_down(&Point3::new(x, 0.0, 0.0), 0.0));
    let start = chain.solve(&from, &HOME_RAD).unwrap();
    for step_m in [0.0, -0.01, f64::NAN, 1e-9] {
        let error = chain.straight(&start, &to, step_m).unwrap_err();
        assert!(error.contains("cannot be divided into steps"), "{error}");
    }
    let nowhere = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(chain.straight(&start, &nowhere, 0.01).is_err());
    let here = chain.base_from_tool(&start).unwrap();
    assert!(chain.straight(&start, &here, 0.01).unwrap().len() <= 2);
}
