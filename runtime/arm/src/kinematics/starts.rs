//! Initial guesses for inverse kinematics, used when the arm's own posture does not lead to a pose.
//!
//! In: a chain and a pose. Out: the arm's home, then other postures within the limits, nearest to the pose first. A Kronecker
//! sequence spreads them evenly over the joint angles, so the list is the same each time. The last joint, and the first one of an arm that
//! stands upright, turn about known axes and are chosen for the pose.

use super::chain::{Angles, Chain, METRES_PER_RAD, about_z, nearest_turn};
use nalgebra::Isometry3;
use std::f64::consts::TAU;
use std::iter;

/// Number of postures in the sequence.
const SPREAD: usize = 256;

/// The inverse of the root of `x^(n + 1) = x + 1` for `n` of 4, 5 and 6. Its powers as fractional increments from posture
/// to posture spread points evenly in so many dimensions (Roberts 2018, "R-sequence").
const STRIDES: [f64; 3] = [
    0.856_674_883_854_502_9,
    0.881_271_461_633_569_6,
    0.898_653_712_628_699_3,
];

/// Returns initial postures, most promising first.
pub(super) fn towards(
    chain: &Chain,
    base_from_tool: Isometry3<f64>,
) -> impl Iterator<Item = Angles> {
    let (_, home) = facing(chain, &base_from_tool, *chain.home());
    let spread = iter::once_with(move || {
        let spread = (0..SPREAD).map(|index| spread(chain, index));
        let mut starts: Vec<(f64, Angles)> = spread
            .map(|angles| facing(chain, &base_from_tool, angles))
            .collect();
        starts.sort_by(|one, other| one.0.total_cmp(&other.0));
        starts.into_iter().map(|(_, start)| start)
    });
    iter::once(home).chain(spread.flatten())
}

fn spread(chain: &Chain, index: usize) -> Angles {
    let mut angles = Angles::default();
    let spread = usize::from(chain.is_upright())..chain.last();
    let root = STRIDES[spread.len().saturating_sub(4).min(2)];
    let mut stride = 1.0;
    for joint in spread {
        stride *= root;
        let part = (0.5 + stride * index as f64).fract();
        let [least, most] = chain.joints()[joint].limits_rad.unwrap_or([0.0, TAU]);
        angles[joint] = least + part * (most - least);
    }
    angles
}

/// Turns the first joint until the tool lies in the pose's direction, and the last to the pose's rotation; also returns
/// the tool's remaining distance from the pose.
fn facing(chain: &Chain, base_from_tool: &Isometry3<f64>, mut angles: Angles) -> (f64, Angles) {
    let tool = chain.tool_at(&angles);
    let azimuth = |pose: &Isometry3<f64>| pose.translation.y.atan2(pose.translation.x);
    let turn = if chain.is_upright() {
        nearest_turn(azimuth(base_from_tool) - azimuth(&tool), 0.0)
    } else {
        0.0
    };
    angles[0] += turn * chain.first_turns();
    let turned = about_z(turn) * tool;
    angles[chain.last()] = chain.last_joint_between(&turned, base_from_tool);
    let left_rad = chain
        .tool_at(&angles)
        .rotation
        .angle_to(&base_from_tool.rotation);
    let left_m = (turned.translation.vector - base_from_tool.translation.vector).norm();
    (left_m / METRES_PER_RAD + left_rad, angles)
}
