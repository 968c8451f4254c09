//! From pixels to the base, by either method.
//!
//! In: pixels whose distortion was taken out, with depth where there is one. Out: points of the base frame, metres, and
//! back. How a fit is found is left to `plane` and `rigid`.

use super::refusal::Fault;
use super::{Method, Pair, Terms, plane, rigid};
use crate::arm::rgbd::Intrinsics;
use crate::camera::Lens;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

/// From pixels to the base.
#[derive(Clone, Debug, PartialEq)]
pub enum Fit {
    /// By the table's plane.
    Plane {
        /// From straightened pixels `(column, row, 1)` to the base's `(x, y, 1)`, metres, up to a factor that is
        /// positive where the camera sees.
        base_from_pixel: Matrix3<f64>,
        /// The table: `z = height[0] + height[1] x + height[2] y`, metres.
        height: [f64; 3],
    },
    /// By the camera's pose.
    Rigid {
        /// Pose of the camera; its frame has x image right, y image down, z the optical axis.
        base_from_camera: Isometry3<f64>,
        /// The table: `z = height[0] + height[1] x + height[2] y`, metres.
        height: [f64; 3],
        /// The size that the depth readings give the table, over the size that the arm gives it; 1 is right.
        scale: f64,
    },
}

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

/// Returns a lens for intrinsics; says what is wrong with them otherwise.
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

/// Prepares points for the solvers.
pub(super) fn sightings(terms: &Terms, pairs: &[Pair]) -> Result<Vec<Sighting>, Fault> {
    let lens = terms.intrinsics.as_ref().map(lens).transpose()?;
    let prepared = pairs.iter().zip(1..).map(|(pair, point)| {
        let straight = match &lens {
            Some(lens) => lens.straightened(pair.pixel),
            None => Some(pair.pixel),
        };
        let pixel = straight.ok_or(Fault::NoRay { point })?;
        let seen = |lens: &Lens| lens.camera_from_pixel(pair.pixel, pair.depth_m?);
        Ok(Sighting {
            pixel,
            seen: lens.as_ref().and_then(seen),
            base: Point3::from(pair.base_m),
        })
    });
    prepared.collect()
}

impl Fit {
    /// Finds the fit of points; `None` where they do not determine one.
    pub(super) fn of(method: Method, points: &[Sighting]) -> Option<Fit> {
        match method {
            Method::Plane => plane::fit(points),
            Method::Rigid => rigid::fit(points),
        }
    }

    /// Returns how far from the tool's place the fit puts a point, metres along the axes of the base.
    ///
    /// `None` where the fit puts it nowhere: beyond the horizon, or without depth.
    pub(super) fn error(&self, point: &Sighting) -> Option<Vector3<f64>> {
        let put = match self {
            Fit::Plane { .. } => self.table_from_straight(point.pixel)?,
            Fit::Rigid {
                base_from_camera, ..
            } => base_from_camera * point.seen?,
        };
        Some(put - point.base)
    }

    /// Returns the point of the table that a straightened pixel of a camera shows, metres, base frame.
    pub(super) fn table_from_straight(&self, pixel: [f64; 2]) -> Option<Point3<f64>> {
        match self {
            Fit::Plane {
                base_from_pixel,
                height,
            } => {
                let [x, y] = crate::camera::through(base_from_pixel, pixel)?;
                Some(Point3::new(x, y, height_at(height, [x, y])))
            }
            // A ray's direction is the lens's business, which is not kept here.
            Fit::Rigid { .. } => None,
        }
    }

    /// Returns the table's height, tilt and offsets: `z = height[0] + height[1] x + height[2] y`, metres, base frame.
    pub fn height(&self) -> [f64; 3] {
        match self {
            Fit::Plane { height, .. } | Fit::Rigid { height, .. } => *height,
        }
    }

    /// Returns the angle between the table and the base's level, degrees.
    pub fn tilt_deg(&self) -> f64 {
        let [_, along_x, along_y] = self.height();
        along_x.hypot(along_y).atan().to_degrees()
    }

    /// Returns the table point that a pixel of the camera's own picture shows, metres, base frame.
    ///
    /// `None` where no ray leads to the pixel, or to the table.
    pub fn table_from_pixel(&self, lens: Option<&Lens>, pixel: [f64; 2]) -> Option<Point3<f64>> {
        match self {
            Fit::Plane { .. } => {
                let straight = match lens {
                    Some(lens) => lens.straightened(pixel)?,
                    None => pixel,
                };
                self.table_from_straight(straight)
            }
            Fit::Rigid {
                base_from_camera,
                height,
                ..
            } => {
                let way = base_from_camera.rotation * lens?.camera_from_pixel(pixel, 1.0)?.coords;
                let eye = base_from_camera.translation.vector;
                let above = |point: Vector3<f64>| point.z - height_at(height, [point.x, point.y]);
                let sinks = above(eye) - above(eye + way);
                let far = above(eye) / sinks;
                (far.is_finite() && far > 0.0).then(|| Point3::from(eye + way * far))
            }
        }
    }

    /// Returns the pixel of the camera's own picture that shows a point, metres, base frame.
    pub fn pixel_from_base(&self, lens: Option<&Lens>, point: Point3<f64>) -> Option<[f64; 2]> {
        match self {
            Fit::Plane {
                base_from_pixel, ..
            } => {
                let plane = crate::camera::Plane {
                    world_from_pixel: *base_from_pixel,
                    height: [0.0; 3],
                    lens: lens.copied(),
                };
                plane.pixel_from_world(point)
            }
            Fit::Rigid {
                base_from_camera, ..
            } => lens?.pixel_from_camera(base_from_camera.inverse_transform_point(&point)),
        }
    }

    /// Returns whether the camera sees the table from above, rather than its mirror image.
    pub(super) fn sees_from_above(&self, middle_px: [f64; 2]) -> bool {
        match self {
            // Columns to rows turn clockwise; seen from above, x to y turn the other way.
            Fit::Plane {
                base_from_pixel, ..
            } => {
                let [u, v] = middle_px;
                let factor = (base_from_pixel * Vector3::new(u, v, 1.0)).z;
                // The sign of the map's own determinant there is that of det(H) / w^3.
                base_from_pixel.determinant() * factor < 0.0
            }
            Fit::Rigid {
                base_from_camera, ..
            } => (base_from_camera.rotation * Vector3::z()).z < 0.0,
        }
    }
}

/// Returns a plane's height at `x`, `y`.
pub(super) fn height_at(height: &[f64; 3], [x, y]: [f64; 2]) -> f64 {
    height[0] + height[1] * x + height[2] * y
}
