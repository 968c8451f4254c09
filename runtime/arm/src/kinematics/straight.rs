//! Joint angles along a straight path of the tool.
//!
//! In: the arm's angles, and a pose. Out: angles at points on the line to it. Each is solved from the angles before it, so the arm keeps its posture; otherwise where on the line that fails, and why.

use super::chain::{Angles, Chain};
use super::inverse::{NO_POSE, is_pose};
use nalgebra::{Isometry3, Translation3};

/// The most that a joint may turn from one point of a line to the next, radians. A step of 10 mm with the hand pointing
/// down, 0.2 m or more from the base's axis, stays below half of it; another posture is several times as far away.
pub const MAX_JUMP_RAD: f64 = 0.4;

/// The largest rotation of the tool between two points, radians: 5 degrees.
const MAX_TURN_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// The most points of a line: 20 m in steps of 10 mm.
const MAX_POINTS: f64 = 2000.0;

impl Chain {
    /// Returns joint angles along the straight line of the tool to a pose, both ends included; the error says how far along
    /// it and why it ends.
    ///
    /// The tool rotates evenly from one pose to the other, the shorter way. Between two points, if the joints move
    /// evenly, the tool leaves the line by less than 0.3 mm when `step_m` is 0.01 and the line stays 0.2 m off the
    /// base's axis.
    ///
    /// - `from_rad`: the arm's angles, which are the first point.
    /// - `to`: `base_from_tool` at the end.
    /// - `step_m`: the largest distance between two points, metres, above 0; a rotation is divided into steps of 5
    ///   degrees.
    pub fn straight(
        &self,
        from_rad: &[f64],
        to: &Isometry3<f64>,
        step_m: f64,
    ) -> Result<Vec<Vec<f64>>, String> {
        let refused = |after_m: f64, why: &str| {
            format!("after `{after_m:.3}` m along the straight path {why}")
        };
        if !is_pose(to) {
            return Err(refused(0.0, NO_POSE));
        }
        let mut last = self.angles(from_rad).map_err(|why| refused(0.0, &why))?;
        let from = &self.tool_at(&last);
        let way_m = (to.translation.vector - from.translation.vector).norm();
        let turn_rad = from.rotation.angle_to(&to.rotation);
        let points = (way_m / step_m).max(turn_rad / MAX_TURN_RAD).ceil();
        if !(step_m > 0.0 && points <= MAX_POINTS) {
            return Err(format!(
                "a path of `{way_m}` m cannot be divided into steps of `{step_m}` m: at most {MAX_POINTS} steps"
            ));
        }
        let mut way = vec![from_rad.to_vec()];
        let mut before = last;
        for point in 1..=points as usize {
            let part = point as f64 / points;
            let after_m = part * way_m;
            let pose = between(from, to, part);
            // Extrapolating leads past postures in which the wrist folds flat and a second family of postures begins.
            let ahead = std::array::from_fn(|index| 2.0 * last[index] - before[index]);
            let step = |start: &Angles| {
                let angles = self.next(&pose, start)?;
                no_jump(&angles, &last).map(|()| angles)
            };
            let angles = step(&ahead).or_else(|_| step(&last));
            let angles = angles.map_err(|why| refused(after_m, &why))?;
            (before, last) = (last, angles);
            way.push(self.of_joints(&angles));
        }
        Ok(way)
    }
}

/// Fails with the first joint, from 1 at the base, that turns too far in one step.
fn no_jump(angles: &Angles, before: &Angles) -> Result<(), String> {
    let turned = angles
        .iter()
        .zip(before)
        .map(|(angle, before)| (angle - before).abs());
    match turned
        .enumerate()
        .find(|(_, turned)| *turned > MAX_JUMP_RAD)
    {
        None => Ok(()),
        Some((index, turned)) => Err(format!(
            "joint `{}` would turn by `{:.0}` degrees in one step, and at most `{:.0}` are allowed",
            index + 1,
            turned.to_degrees(),
            MAX_JUMP_RAD.to_degrees()
        )),
    }
}

/// Interpolates between two poses, at a fraction from 0 to 1.
fn between(from: &Isometry3<f64>, to: &Isometry3<f64>, part: f64) -> Isometry3<f64> {
    let place = from.translation.vector.lerp(&to.translation.vector, part);
    // Half a turn has no shorter direction; any will do.
    let turned = from.rotation.try_slerp(&to.rotation, part, 1e-9);
    let rotation = turned.unwrap_or_else(|| {
        let way = (to.rotation * from.rotation.inverse()).scaled_axis() * part;
        nalgebra::UnitQuaternion::from_scaled_axis(way) * from.rotation
    });
    Isometry3::from_parts(Translation3::from(place), rotation)
}
