//! A plane seen by a camera whose own pose is unknown.
//!
//! In: the homography from pixels to the plane. Out: points of the plane, and the pixels that show them.

use super::Lens;
use super::lens::all_finite;
use nalgebra::{Matrix3, Point3, Vector3};

/// How pixels lie on a plane of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// From undistorted pixels `(column, row, 1)` to the world's `(x, y, 1)`, metres, up to a factor that is positive
    /// for everything the camera sees.
    pub world_from_pixel: Matrix3<f64>,
    /// The plane's height: `z = height[0] + height[1] x + height[2] y`, metres.
    pub height: [f64; 3],
    /// The lens, if it has distortion; only its distortion counts.
    pub lens: Option<Lens>,
}

impl Plane {
    /// Returns the point of the plane that a pixel shows; `None` beyond the horizon.
    pub fn world_from_pixel(&self, pixel: [f64; 2]) -> Option<Point3<f64>> {
        let [u, v] = match &self.lens {
            Some(lens) => lens.straightened(pixel)?,
            None => pixel,
        };
        let [x, y] = through(&self.world_from_pixel, [u, v])?;
        let [level, along_x, along_y] = self.height;
        Some(Point3::new(x, y, level + along_x * x + along_y * y))
    }

    /// Returns the pixel that shows the plane's point below or above a point; `None` if no pixel does.
    pub fn pixel_from_world(&self, point: Point3<f64>) -> Option<[f64; 2]> {
        let pixel_from_world = self.world_from_pixel.try_inverse()?;
        // The factor's sign is known only from pixel to world, so check by mapping the result back.
        let pixel = divided(pixel_from_world * Vector3::new(point.x, point.y, 1.0))?;
        through(&self.world_from_pixel, pixel)?;
        match &self.lens {
            Some(lens) => lens.bent(pixel),
            None => Some(pixel),
        }
    }
}

/// Returns the image of a point under a homography; `None` unless the factor is positive.
pub fn through(homography: &Matrix3<f64>, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
    let image = homography * Vector3::new(u, v, 1.0);
    (image.z > 0.0).then(|| divided(image))?
}

fn divided(point: Vector3<f64>) -> Option<[f64; 2]> {
    all_finite([point.x / point.z, point.y / point.z])
}
