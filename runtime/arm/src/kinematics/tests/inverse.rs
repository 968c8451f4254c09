//! Tests of inverse kinematics: its solutions, limits, nearness, and refusals.

use super::*;
use nalgebra::UnitQuaternion;
use std::time::{Duration, Instant};

proptest! {
    #[test]
    #[ignore = "long"]
    fn a_pose_that_the_arm_has_is_found_from_any_other(
        (chain, angles) in posed(),
        near in prop::collection::vec(-20.0..20.0f64, MIN_JOINTS),
    ) {
        let pose = chain.base_from_tool(&angles).unwrap();
        let found = chain.solve(&pose, &near).unwrap();
        let reached = chain.base_from_tool(&found).unwrap();
        prop_assert!(distance_m(&reached, &pose) <= 1e-4);
        prop_assert!(angle_deg(&reached, &pose) <= 0.01);
        prop_assert!(chain.is_within_limits(&found));
        for ((joint, found), near) in chain.joints().iter().zip(&found).zip(&near) {
            let turns = (found - near).abs() / TAU;
            prop_assert!(joint.limits_rad.is_some() || turns <= 0.5 + 1e-9, "{} turns away", turns);
        }
    }

    #[test]
    fn a_pose_nearby_is_reached_in_the_same_posture((chain, angles) in posed(), by in prop::array::uniform6(-0.02..0.02f64)) {
        let near: Vec<f64> = angles.iter().zip(by).map(|(angle, by)| angle + by).collect();
        let pose = chain.base_from_tool(&angles).unwrap();
        let found = chain.solve(&pose, &near).unwrap();
        let (_, jacobian) = chain.motion_at(&chain.angles(&angles).unwrap());
        let columns = jacobian.columns(0, MIN_JOINTS).into_owned();
        let singular = columns.svd(false, false).singular_values.min() < 0.02;
        for (found, angle) in found.iter().zip(&angles) {
            prop_assert!(singular || (found - angle).abs() < 1e-6, "{} is not {}", found, angle);
        }
    }

    #[test]
    fn equal_input_gives_equal_bits((chain, angles) in posed()) {
        let pose = chain.base_from_tool(&angles).unwrap();
        prop_assert_eq!(chain.solve(&pose, &HOME_RAD), chain.solve(&pose, &HOME_RAD));
    }

    #[test]
    fn any_pose_gets_an_answer_soon(
        numbers in prop::array::uniform3(prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(1e300), -1.0..1.0f64]),
        turn in prop::array::uniform3(-7.0..7.0f64),
        near in prop::collection::vec(prop_oneof![Just(f64::NAN), Just(1e300), -9.0..9.0f64], 0..8),
    ) {
        let begun = Instant::now();
        let rotation = UnitQuaternion::from_scaled_axis(turn.into());
        let pose = Isometry3::from_parts(numbers.into(), rotation);
        let found = chain_of("j2n6s200").solve(&pose, &near);
        prop_assert!(found.is_err() || numbers.iter().all(|number| number.abs() < 1.2));
        prop_assert!(begun.elapsed() < Duration::from_secs(2));
    }
}
