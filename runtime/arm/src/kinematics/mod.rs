//! Forward and inverse kinematics of an arm, straight paths, and reach.
//!
//! In: joints and shapes that a URDF describes; angles, poses and points in the base frame, metres and radians. Out: frames, angles, straight paths, and the range that a hand pointing down reaches. Collisions of the arm
//! with itself, the table or anything else are not checked here.

pub mod chain;
pub mod inverse;
pub mod reach;
pub mod shape;
mod starts;
pub mod straight;
pub mod tool_down;

use nalgebra::{Isometry3, Translation3, UnitQuaternion};

/// Returns the frame at a place, metres, rotated about the fixed x, y and z, radians, in this order.
pub(crate) fn frame(xyz_m: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::from(xyz_m),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}

#[cfg(test)]
mod tests;
