//! Compares with MuJoCo's model of the arm in `dm_control`: a Jaco 2 with six joints, a wrist with 60-degree bends and
//! three fingers, which is the vendor's `j2n6s300`. Its angles follow the vendor's convention, and its links' frames
//! are as here. It has two tool frames: `wristsite` is rotated like ours and sits at the start of the hand, whose
//! stated length is 0.160 m along z; `gripsite` is 1.0 mm from our tool.

use super::*;
use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::strategy::ValueTree;
use serde::Deserialize;
use std::io::Write;
use std::process::{Command, Stdio};

const SAMPLES: usize = 1000;

#[derive(Deserialize)]
struct MujocoOutput {
    fingers: usize,
    limits_rad: [Option<[f64; 2]>; MIN_JOINTS],
    poses: Vec<Poses>,
}

#[derive(Deserialize)]
struct Poses {
    links: [Pose; MIN_JOINTS],
    wrist: Pose,
    grip: Pose,
}

#[derive(Deserialize)]
struct Pose {
    position_m: [f64; 3],
    rotation: [[f64; 3]; 3],
}

impl Pose {
    fn isometry(&self) -> Isometry3<f64> {
        let columns = Matrix3::from(self.rotation).transpose();
        let rotation = Rotation3::from_matrix_unchecked(columns);
        Isometry3::from_parts(Vector3::from(self.position_m).into(), rotation.into())
    }
}

fn ask_mujoco(angles: &[Vec<f64>]) -> MujocoOutput {
    let python = std::env::var_os("FABC_PEER_PYTHON").expect("make test-all names a Python");
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/peers/arm_poses.py"
    );
    let mut peer = Command::new(python)
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let question = serde_json::json!({ "angles": angles }).to_string();
    peer.stdin
        .take()
        .unwrap()
        .write_all(question.as_bytes())
        .unwrap();
    let output = peer.wait_with_output().unwrap();
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Angles spread over all postures, the same each time.
fn samples(chain: &Chain) -> Vec<Vec<f64>> {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let strategy = within_limits(chain);
    let sample = |_| strategy.new_tree(&mut runner).unwrap().current();
    (0..SAMPLES).map(sample).collect()
}

#[test]
#[ignore = "needs Python with mujoco and dm_control"]
fn peer_mujoco_has_every_link_where_the_chain_has_it() {
    let chain = chain_of("j2n6s300");
    let angles = samples(&chain);
    let output = ask_mujoco(&angles);
    assert_eq!(output.fingers, 3);
    for (joint, limits) in chain.joints().iter().zip(output.limits_rad) {
        let apart = |ours: [f64; 2], theirs: [f64; 2]| {
            (ours[0] - theirs[0]).abs().max((ours[1] - theirs[1]).abs())
        };
        match (joint.limits_rad, limits) {
            (None, None) => {}
            (Some(ours), Some(theirs)) => {
                assert!(apart(ours, theirs) < 1e-5, "{ours:?} {theirs:?}")
            }
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(output.poses.len(), SAMPLES);
    let tool_from_wrist = Isometry3::translation(0.0, 0.0, -0.160);
    for (angles, poses) in angles.iter().zip(&output.poses) {
        let frames = chain.frames(angles).unwrap();
        let wrist = frames[MIN_JOINTS] * tool_from_wrist;
        let ours = frames[..MIN_JOINTS].iter().chain([&wrist]);
        // Its files round to six digits.
        for (ours, theirs) in ours.zip(poses.links.iter().chain([&poses.wrist])) {
            let theirs = theirs.isometry();
            assert!(distance_m(ours, &theirs) < 1e-5, "{ours} {theirs}");
            assert!(angle_deg(ours, &theirs) < 1e-3, "{ours} {theirs}");
        }
        let grip = poses.grip.isometry();
        assert!(distance_m(&frames[MIN_JOINTS], &grip) < 0.0011, "{grip}");
        assert!(angle_deg(&frames[MIN_JOINTS], &grip) < 1e-3, "{grip}");
    }
}

#[test]
#[ignore = "needs Python with mujoco and dm_control"]
fn peer_mujoco_lands_where_inverse_kinematics_was_sent() {
    let chain = chain_of("j2n6s300");
    let targets: Vec<_> = samples(&chain)
        .iter()
        .map(|angles| chain.base_from_tool(angles).unwrap())
        .collect();
    let solved: Vec<_> = targets
        .iter()
        .map(|target| chain.solve(target, &HOME_RAD).unwrap())
        .collect();
    let output = ask_mujoco(&solved);
    assert_eq!(output.poses.len(), SAMPLES);
    for (target, poses) in targets.iter().zip(&output.poses) {
        let landed = poses.wrist.isometry() * Isometry3::translation(0.0, 0.0, 0.160);
        assert!(distance_m(&landed, target) < 1.2e-4, "{landed} {target}");
        assert!(angle_deg(&landed, target) < 0.012, "{landed} {target}");
    }
}
