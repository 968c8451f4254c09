//! Tests of forward kinematics: the vendor's home pose, frames, the Jacobian, refusals.

use super::*;
use nalgebra::{Rotation3, Vector3};

#[test]
fn the_vendors_home_pose_comes_out_as_the_arm_tells_it() {
    for model in ["j2n6s200", "j2n6s300"] {
        let tool = chain_of(model).base_from_tool(&HOME_RAD).unwrap();
        let [x, y, z] = HOME_EULER_RAD;
        let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), x)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), y)
            * Rotation3::from_axis_angle(&Vector3::z_axis(), z);
        let told = Isometry3::from_parts(Vector3::from(HOME_M).into(), turn.into());
        // The vendor gives joints and pose for two arms, each slightly different.
        assert!(distance_m(&tool, &told) < 0.003, "{tool} is not {told}");
        assert!(angle_deg(&tool, &told) < 1.5, "{tool} is not {told}");
    }
}

#[test]
fn straight_up_the_arm_is_as_high_as_its_lengths_add_up_to() {
    // D1 + D2 + D3 + 2 * 0.10375 + D6, the vendor's figures for the spherical wrist.
    let lengths_m = 0.2755 + 0.410 + 0.2073 + 0.2075 + 0.160;
    let half = std::f64::consts::PI;
    let tool = chain_of("j2s6s200")
        .base_from_tool(&[0.0, half, half, 0.0, half, 0.0])
        .unwrap();
    assert!((tool.translation.z - lengths_m).abs() < 1e-9, "{tool}");
}

#[test]
fn every_model_states_limits_and_speeds() {
    for model in MODELS {
        let chain = chain_of(model);
        assert_eq!(chain.model(), model);
        let endless = chain
            .joints()
            .iter()
            .filter(|joint| joint.limits_rad.is_none())
            .count();
        assert_eq!(endless, if model == "j2s6s200" { 3 } else { 4 });
        for joint in chain.joints() {
            let speed_deg_s = joint.max_speed_rad_s.to_degrees();
            assert!(
                (35.9..48.1).contains(&speed_deg_s),
                "{model}: {speed_deg_s}"
            );
            let limits = joint.limits_rad.unwrap_or([1.0, 2.0]);
            assert!(0.0 < limits[0] && limits[0] < limits[1] && limits[1] < TAU);
        }
    }
    assert_eq!(Chain::models(), MODELS);
}

#[test]
fn an_unknown_model_has_no_chain() {
    assert!(Chain::of_model("j2n7s300").is_none());
}

#[test]
fn what_are_no_angles_is_refused() {
    let chain = chain_of("j2n6s200");
    let count = chain.base_from_tool(&[0.0; 5]).unwrap_err();
    assert_eq!(
        count,
        "`5` joint angles were given to an arm with `6` joints"
    );
    assert!(chain.frames(&[]).is_err());
    for bad in [f64::NAN, f64::INFINITY, -1e300] {
        let mut angles = HOME_RAD;
        angles[2] = bad;
        let error = chain.base_from_tool(&angles).unwrap_err();
        assert!(
            error
                .to_string()
                .ends_with("of joint `3` is not a valid angle"),
            "{error}"
        );
    }
}

proptest! {
    #[test]
    fn frames_end_with_the_tool_and_keep_their_distances((chain, angles) in posed()) {
        let frames = chain.frames(&angles).unwrap();
        prop_assert_eq!(frames.len(), MIN_JOINTS + 1);
        prop_assert_eq!(frames[MIN_JOINTS], chain.base_from_tool(&angles).unwrap());
        for (pair, joint) in frames.windows(2).zip(&chain.joints()[1..]) {
            let link_m = joint.parent_from_joint_at_zero.translation.vector.norm();
            prop_assert!((distance_m(&pair[0], &pair[1]) - link_m).abs() < 1e-12);
        }
    }

    #[test]
    fn the_jacobian_is_how_the_tool_moves((chain, angles) in posed(), joint in 0..MIN_JOINTS) {
        const STEP_RAD: f64 = 1e-6;
        let moved = |by: f64| {
            let mut angles = angles.clone();
            angles[joint] += by;
            chain.base_from_tool(&angles).unwrap()
        };
        let (before, after) = (moved(-STEP_RAD), moved(STEP_RAD));
        let velocity = (after.translation.vector - before.translation.vector) / (2.0 * STEP_RAD);
        let spin = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * STEP_RAD);
        let (_, jacobian) = chain.motion_at(&chain.angles(&angles).unwrap());
        let column = jacobian.column(joint);
        prop_assert!((column.fixed_rows::<3>(0) - velocity).norm() < 1e-8);
        prop_assert!((column.fixed_rows::<3>(3) - spin).norm() < 1e-8);
    }
}
