//! A camera without distortion, in the form that programs in other languages read and write.
//!
//! In and out: plain numbers, the camera's pose as a matrix of four rows.

use super::{Camera, Lens, Projection};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// How far the pose's upper left may be from a rotation, as the largest entry of `R * R^T - I`.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// A camera without distortion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pinhole {
    /// Distance of the image plane along columns and rows, pixels.
    pub focal_px: [f64; 2],
    /// Where the optical axis meets the image, pixels; the first pixel's centre is at 0.5.
    pub center_px: [f64; 2],
    /// Pose, row by row, metres. In the camera's own frame x is image right, y image down, z the optical axis.
    pub world_from_camera: [[f64; 4]; 4],
}

impl Pinhole {
    /// Describes a camera; `None` for a camera with distortion or a plane-only one.
    pub fn of(camera: &Camera) -> Option<Pinhole> {
        let (world_from_camera, lens) = match &camera.projection {
            Projection::Pinhole {
                world_from_camera,
                lens,
            } if !lens.is_distorted() => (world_from_camera, lens),
            _ => return None,
        };
        let pose = world_from_camera.to_homogeneous();
        Some(Pinhole {
            focal_px: lens.focal_px,
            center_px: lens.middle_px,
            world_from_camera: std::array::from_fn(|row| std::array::from_fn(|at| pose[(row, at)])),
        })
    }

    /// Makes the camera for pictures of a given size; fails with the reason if a number is impossible.
    pub fn camera(&self, size_px: [u32; 2]) -> Result<Camera, String> {
        let [fx, fy] = self.focal_px;
        if !self.focal_px.iter().all(|focal| *focal > 0.0) {
            return Err(format!(
                "`focal_px` is [{fx}, {fy}], and both have to be above 0"
            ));
        }
        let numbers = self.world_from_camera.as_flattened().iter();
        let mut numbers = numbers.chain(&self.center_px).chain(&self.focal_px);
        if !numbers.all(|number| number.is_finite()) {
            return Err("a number of the camera is not finite".to_owned());
        }
        let pose = &self.world_from_camera;
        let turn = Matrix3::from_fn(|row, column| pose[row][column]);
        let error = (turn * turn.transpose() - Matrix3::identity()).abs().max();
        if error > ROTATION_TOLERANCE || turn.determinant() < 0.0 || pose[3] != [0.0, 0.0, 0.0, 1.0]
        {
            return Err(
                "`world_from_camera` is not a pose: its upper left must be a rotation, its last row 0, 0, 0, 1"
                    .to_owned(),
            );
        }
        let rotation = Rotation3::from_matrix_unchecked(turn);
        Ok(Camera {
            projection: Projection::Pinhole {
                world_from_camera: Isometry3::from_parts(
                    Translation3::from(Vector3::from_fn(|row, _| pose[row][3])),
                    UnitQuaternion::from_rotation_matrix(&rotation),
                ),
                lens: Lens::undistorted(self.focal_px, self.center_px),
            },
            size_px,
        })
    }
}

#[cfg(test)]
#[path = "tests/pinhole.rs"]
mod tests;
