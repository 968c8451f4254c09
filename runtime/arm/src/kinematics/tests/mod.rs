//! Tests of laws and vendor's figures that hold for every model; and shared helpers.

#![allow(clippy::unwrap_used)]

mod chain;
mod inverse;
mod reach;
mod shape;
mod straight;

use super::chain::{Chain, MIN_JOINTS};
use super::inverse::is_pose;
use nalgebra::Isometry3;
use proptest::prelude::*;
use std::f64::consts::TAU;

const MODELS: [&str; 3] = ["j2n6s200", "j2n6s300", "j2s6s200"];

/// Joint angles of the vendor's home pose, radians, and the tool pose that the arm reports there: metres, and Euler
/// angles about x, y, z in kinova-ros's convention (`kinova_demo/nodes/kinova_demo/pose_action_client.py`).
const HOME_RAD: [f64; MIN_JOINTS] = [4.8085, 2.9246, 1.0020, 4.2031, 1.4454, 1.3233];
const HOME_M: [f64; 3] = [0.2123, -0.2572, 0.5096];
const HOME_EULER_RAD: [f64; 3] = [1.6377, 1.1132, 0.1341];

fn chain_of(model: &str) -> Chain {
    Chain::of_model(model).unwrap()
}

impl Chain {
    /// Returns angles for a pose: near others, or else those to which one of 64 starts leads.
    pub(crate) fn solve(
        &self,
        pose: &Isometry3<f64>,
        near_rad: &[f64],
    ) -> Result<Vec<f64>, String> {
        let near = self.angles(near_rad)?;
        if !is_pose(pose) {
            return Err("no pose".to_owned());
        }
        let mut start = near;
        start[self.last()] += self.last_joint_between(&self.tool_at(&near), pose);
        let mut others = self.search(*pose).take(64);
        let found = self.next(pose, &start).or_else(|why| {
            let found = others.find(|attempt| attempt.reached());
            found.map(|it| it.angles).ok_or(why)
        });
        Ok(self.of_joints(&self.turns_nearest(&found?, &near)))
    }

    /// Returns whether no angle exceeds a limit of its joint.
    pub(crate) fn is_within_limits(&self, joints_rad: &[f64]) -> bool {
        let mut pairs = self.joints().iter().zip(joints_rad);
        pairs.all(|(joint, angle)| {
            let limits = joint.limits_rad;
            limits.is_none_or(|[least, most]| (least..=most).contains(angle))
        })
    }
}

fn distance_m(one: &Isometry3<f64>, other: &Isometry3<f64>) -> f64 {
    (one.translation.vector - other.translation.vector).norm()
}

fn angle_deg(one: &Isometry3<f64>, other: &Isometry3<f64>) -> f64 {
    one.rotation.angle_to(&other.rotation).to_degrees()
}

/// Angles within a chain's limits; within one turn for unlimited joints.
fn within_limits(chain: &Chain) -> impl Strategy<Value = Vec<f64>> + use<> {
    let ranges: Vec<_> = chain
        .joints()
        .iter()
        .map(|joint| joint.limits_rad.unwrap_or([0.0, TAU]))
        .collect();
    let angle = |[least, most]: [f64; 2]| least..=most;
    ranges.into_iter().map(angle).collect::<Vec<_>>()
}

/// A model with angles for it.
fn posed() -> impl Strategy<Value = (Chain, Vec<f64>)> {
    prop::sample::select(MODELS.to_vec()).prop_flat_map(|model| {
        let chain = chain_of(model);
        let angles = within_limits(&chain);
        (Just(chain), angles)
    })
}
