//! A touched point, made ready for the solvers.
//!
//! Its pixel is straightened, and its place in the camera's frame is known where depth and lens are.

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
