//! Fits the map from pixels to the table: a homography, and the plane through the touched heights.
//!
//! In: points and the camera's lens. Out: a [`Plane`] in the base frame, and how far points are from it. Finding the
//! homography is left to `plane`.

use super::fault::Fault;
use super::{Pair, plane};
use crate::rgbd::Intrinsics;
use fab_picture::camera::{Lens, Plane, through};
use nalgebra::{Point3, Vector3};

/// A touched point in the form that the solvers use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sighting {
    /// Its undistorted pixel.
    pub pixel: [f64; 2],
    /// Its position touched by the tool, metres, base frame.
    pub base: Point3<f64>,
}

/// Makes a lens from intrinsics; fails with their fault.
pub(super) fn lens(intrinsics: &Intrinsics) -> Result<Lens, Fault> {
    let wrong = |why: String| Fault::Intrinsics { why };
    let mut distortion = [0.0; 5];
    let given = &intrinsics.distortion;
    if !matches!(given.len(), 0 | 4 | 5) {
        let n = given.len();
        return Err(wrong(format!(
            "`distortion` has {n} coefficients; `plumb_bob` has 4 or 5, and none is right too"
        )));
    }
    for (to, from) in distortion.iter_mut().zip(given) {
        *to = *from;
    }
    let numbers = intrinsics.focal_px.iter().chain(&intrinsics.middle_px);
    if !numbers.chain(given).all(|number| number.is_finite()) {
        return Err(wrong("a number is not finite".to_owned()));
    }
    if intrinsics.focal_px.iter().any(|focal| *focal <= 0.0) {
        let [across, down] = intrinsics.focal_px;
        return Err(wrong(format!(
            "`focal_px` is {across} and {down}; both are positive"
        )));
    }
    Ok(Lens {
        focal_px: intrinsics.focal_px,
        middle_px: intrinsics.middle_px,
        distortion,
    })
}

/// Prepares points; fails if no ray leads to a pixel.
pub(super) fn sightings(lens: &Lens, pairs: &[Pair]) -> Result<Vec<Sighting>, Fault> {
    let sighting = |(pair, point): (&Pair, usize)| {
        let pixel = lens.straightened(pair.pixel);
        let base = Point3::from(pair.base_m);
        let prepared = pixel.map(|pixel| Sighting { pixel, base });
        prepared.ok_or(Fault::NoRay { point })
    };
    pairs.iter().zip(1..).map(sighting).collect()
}

/// Finds the fit of points; `None` if they do not determine one.
pub(super) fn fit(lens: &Lens, points: &[Sighting]) -> Option<Plane> {
    Some(Plane {
        world_from_pixel: plane::homography(points)?,
        height: plane::heights(points)?,
        lens: Some(*lens),
    })
}

/// Returns the offset of the fit's place for a point from the tool's, metres along the axes of the base; `None` beyond
/// the horizon.
pub(super) fn error(fit: &Plane, point: &Sighting) -> Option<Vector3<f64>> {
    let [x, y] = through(&fit.world_from_pixel, point.pixel)?;
    Some(Point3::new(x, y, height_at(&fit.height, [x, y])) - point.base)
}

/// Returns the angle between the table and the base's horizontal plane, degrees.
pub fn tilt_deg(fit: &Plane) -> f64 {
    let [_, along_x, along_y] = fit.height;
    along_x.hypot(along_y).atan().to_degrees()
}

/// Returns a plane's height at `x`, `y`.
pub(super) fn height_at(height: &[f64; 3], [x, y]: [f64; 2]) -> f64 {
    height[0] + height[1] * x + height[2] * y
}
