//! A touched point, prepared for the solvers.
//!
//! Its pixel is undistorted; its position in the camera's frame is known if depth and lens are.

use nalgebra::Point3;

/// A point as the solvers take it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    /// Its pixel with the lens's distortion taken out.
    pub pixel: [f64; 2],
    /// Where it is in the camera's frame, metres, where depth and lens are known.
    pub seen: Option<Point3<f64>>,
    /// Where the tool touched it, metres, base frame.
    pub base: Point3<f64>,
}
