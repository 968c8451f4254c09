//! Draws measured points and their errors.
//!
//! In: the camera's own picture, points, their fit. Out: the picture with a ring and a number at each point and an
//! arrow towards where the fit expects it, ten times as long as the error.

use fab_arm::calibration::Pair;
use fab_picture::camera::Plane;
use fab_vision::{VisionError, draw_residuals};
use image::RgbImage;
use nalgebra::Point3;

/// Arrow length as a multiple of the error.
const TIMES: f64 = 10.0;

/// Draws points with their errors; without a fit, only the points.
pub fn draw_errors(
    picture: &mut RgbImage,
    pairs: &[Pair],
    fit: Option<&Plane>,
) -> Result<(), VisionError> {
    let places: Vec<_> = pairs
        .iter()
        .map(|pair| {
            let expected = fit.and_then(|fit| fit.pixel_from_world(Point3::from(pair.base_m)));
            (pair.pixel, expected)
        })
        .collect();
    draw_residuals(picture, &places, TIMES)
}
