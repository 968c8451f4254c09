//! Initial guesses for inverse kinematics, used when the arm's own posture does not lead to a pose.
//!
//! In: a chain and a pose. Out: postures within the limits, nearest to the pose first. A Kronecker sequence spreads
//! them evenly over the joint angles, so the list is the same each time. The first and the last joint turn about known
//! axes and are chosen for the pose.

use super::chain::{Angles, Chain, METRES_PER_RAD, about_z, nearest_turn};
use nalgebra::Isometry3;
use std::f64::consts::TAU;

/// Number of postures in the sequence.
const SPREAD: usize = 256;

/// Fractional increments of the four middle joints from posture to posture: powers of the inverse of the root of `x^5 =
/// x + 1`, which spread points evenly in four dimensions (Roberts 2018, "R-sequence").
const STRIDES: [f64; 4] = [
    0.856_674_883_854_502_9,
    0.733_891_856_627_126_6,
    0.628_706_721_038_087_2,
    0.538_597_254_223_615_3,
];

/// Returns initial postures, most promising first.
pub(super) fn towards(chain: &Chain, base_from_tool: &Isometry3<f64>) -> Vec<Angles> {
    let mut starts: Vec<(f64, Angles)> = (0..SPREAD)
        .map(|index| facing(chain, base_from_tool, spread(chain, index)))
        .collect();
    starts.sort_by(|one, other| one.0.total_cmp(&other.0));
    starts.into_iter().map(|(_, start)| start).collect()
}

fn spread(chain: &Chain, index: usize) -> Angles {
    let mut angles = Angles::default();
    for (joint, stride) in (1..=4).zip(STRIDES) {
        let part = (0.5 + stride * index as f64).fract();
        let [least, most] = chain.joints()[joint].limits_rad.unwrap_or([0.0, TAU]);
        angles[joint] = least + part * (most - least);
    }
    angles
}

/// Turns the first joint until the tool lies in the pose's direction, and the last to the pose's rotation; also returns
/// the tool's remaining distance from the pose.
fn facing(
    chain: &Chain,
    base_from_tool: &Isometry3<f64>,
    mut angles: Angles,
) -> (f64, Angles) {
    let tool = chain.tool_at(&angles);
    let azimuth = |pose: &Isometry3<f64>| pose.translation.y.atan2(pose.translation.x);
    let turn = nearest_turn(azimuth(base_from_tool) - azimuth(&tool), 0.0);
    angles[0] = turn * chain.first_turns();
    let turned = about_z(turn) * tool;
    angles[chain.last()] = chain.last_joint_between(&turned, base_from_tool);
    let left_rad = chain
        .tool_at(&angles)
        .rotation
        .angle_to(&base_from_tool.rotation);
    let left_m = (turned.translation.vector - base_from_tool.translation.vector).norm();
    (left_m / METRES_PER_RAD + left_rad, angles)
}
