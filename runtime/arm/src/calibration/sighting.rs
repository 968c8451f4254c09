//! A touched point, prepared for the solvers.
//!
//! Its pixel is undistorted; its position in the camera's frame is known if depth and lens are.

use nalgebra::Point3;

/// A point in the form that the solvers use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    /// Its undistorted pixel.
    pub pixel: [f64; 2],
    /// Its position in the camera's frame, metres, if depth and lens are known.
    pub seen: Option<Point3<f64>>,
    /// Its position touched by the tool, metres, base frame.
    pub base: Point3<f64>,
}
