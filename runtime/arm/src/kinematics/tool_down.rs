//! The pose of a hand that points straight down.

use super::chain::about_z;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Returns the pose of a hand that points straight down.
///
/// - `point`: position of its tool, base frame, metres.
/// - `turn_rad`: its rotation about the base's vertical; at 0 the tool's x axis lies along the base's.
pub fn tool_down(point: &Point3<f64>, turn_rad: f64) -> Isometry3<f64> {
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    Isometry3::from_parts(Translation3::from(point.coords), about_z(turn_rad) * down)
}
