//! Maps pixels to the base frame, by either method.
//!
//! In: undistorted pixels, with depth if available. Out: points in the base frame, metres, and back. Finding a fit is
//! left to `plane` and `rigid`.

use super::fault::Fault;
use super::sighting::Sighting;
use super::{Method, Pair, Terms, plane, rigid};
use crate::rgbd::Intrinsics;
use fab_picture::camera::{Lens, Plane, through};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

/// A map from pixels to the base frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Fit {
    /// By the table's plane.
    Plane {
        /// From undistorted pixels `(column, row, 1)` to the base's `(x, y, 1)`, metres, up to a factor that is
        /// positive for everything the camera sees.
        base_from_pixel: Matrix3<f64>,
        /// The table: `z = height[0] + height[1] x + height[2] y`, metres.
        height: [f64; 3],
        /// The lens that undistorts pixels, if known.
        lens: Option<Lens>,
    },
    /// By the camera's pose.
    Rigid {
        /// Pose of the camera; its frame has x image right, y image down, z the optical axis.
        base_from_camera: Isometry3<f64>,
        /// The camera's lens.
        lens: Lens,
        /// The table: `z = height[0] + height[1] x + height[2] y`, metres.
        height: [f64; 3],
        /// Size of the table according to depth readings, divided by its size according to the arm; 1 is right.
        scale: f64,
    },
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

/// The inputs of a fit other than its points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solver {
    method: Method,
    /// The camera's lens, if known.
    pub lens: Option<Lens>,
}

impl Solver {
    pub(super) fn of(terms: &Terms) -> Result<Solver, Fault> {
        Ok(Solver {
            method: terms.method,
            lens: terms.intrinsics.as_ref().map(lens).transpose()?,
        })
    }

    /// Prepares a point; `None` if no ray leads to its pixel.
    pub(super) fn sighting(&self, pair: &Pair) -> Option<Sighting> {
        let seen = |lens: &Lens| lens.camera_from_pixel(pair.pixel, pair.depth_m?);
        Some(Sighting {
            pixel: straightened(self.lens.as_ref(), pair.pixel)?,
            seen: self.lens.as_ref().and_then(seen),
            base: Point3::from(pair.base_m),
        })
    }

    pub(super) fn sightings(&self, pairs: &[Pair]) -> Result<Vec<Sighting>, Fault> {
        let numbered = pairs.iter().zip(1..);
        numbered
            .map(|(pair, point)| self.sighting(pair).ok_or(Fault::NoRay { point }))
            .collect()
    }

    /// Finds the fit of points; `None` if they do not determine one.
    pub(super) fn fit(&self, points: &[Sighting]) -> Option<Fit> {
        match self.method {
            Method::Plane => Some(Fit::Plane {
                base_from_pixel: plane::homography(points)?,
                height: plane::heights(points)?,
                lens: self.lens,
            }),
            Method::Rigid => {
                let (base_from_camera, scale) = rigid::pose(points)?;
                Some(Fit::Rigid {
                    base_from_camera,
                    lens: self.lens?,
                    height: plane::heights(points)?,
                    scale,
                })
            }
        }
    }
}

impl Fit {
    /// Returns the offset of the fit's position for a point from the tool's position, metres along the axes of the
    /// base.
    ///
    /// `None` if the fit cannot locate it: beyond the horizon, or without depth.
    pub(super) fn error(&self, point: &Sighting) -> Option<Vector3<f64>> {
        let put = match self {
            Fit::Plane {
                base_from_pixel,
                height,
                ..
            } => on_table(base_from_pixel, height, point.pixel)?,
            Fit::Rigid {
                base_from_camera, ..
            } => base_from_camera * point.seen?,
        };
        Some(put - point.base)
    }

    /// Returns the table's height, tilt and offsets: `z = height[0] + height[1] x + height[2] y`, metres, base frame.
    pub fn height(&self) -> [f64; 3] {
        match self {
            Fit::Plane { height, .. } | Fit::Rigid { height, .. } => *height,
        }
    }

    /// Returns the lens, if known.
    pub fn lens(&self) -> Option<&Lens> {
        match self {
            Fit::Plane { lens, .. } => lens.as_ref(),
            Fit::Rigid { lens, .. } => Some(lens),
        }
    }

    /// Returns the angle between the table and the base's horizontal plane, degrees.
    pub fn tilt_deg(&self) -> f64 {
        let [_, along_x, along_y] = self.height();
        along_x.hypot(along_y).atan().to_degrees()
    }

    /// Returns the table point that a pixel of the camera's own picture shows, metres, base frame.
    ///
    /// `None` if no ray leads to the pixel, or to the table.
    pub fn table_from_pixel(&self, pixel: [f64; 2]) -> Option<Point3<f64>> {
        match self {
            Fit::Plane {
                base_from_pixel,
                height,
                lens,
            } => on_table(base_from_pixel, height, straightened(lens.as_ref(), pixel)?),
            Fit::Rigid {
                base_from_camera,
                lens,
                height,
                ..
            } => {
                let way = base_from_camera.rotation * lens.camera_from_pixel(pixel, 1.0)?.coords;
                let eye = base_from_camera.translation.vector;
                let above = |point: Vector3<f64>| point.z - height_at(height, [point.x, point.y]);
                let far = above(eye) / (above(eye) - above(eye + way));
                (far.is_finite() && far > 0.0).then(|| Point3::from(eye + way * far))
            }
        }
    }

    /// Returns the pixel of the camera's own picture that shows a point, metres, base frame.
    ///
    /// By the table's plane, it is the pixel that shows the plane's point below or above the point.
    pub fn pixel_from_base(&self, point: Point3<f64>) -> Option<[f64; 2]> {
        match self {
            Fit::Plane {
                base_from_pixel,
                height,
                lens,
            } => {
                let plane = Plane {
                    world_from_pixel: *base_from_pixel,
                    height: *height,
                    lens: *lens,
                };
                plane.pixel_from_world(point)
            }
            Fit::Rigid {
                base_from_camera,
                lens,
                ..
            } => lens.pixel_from_camera(base_from_camera.inverse_transform_point(&point)),
        }
    }

    /// Returns whether the camera sees the table from above, rather than its mirror image.
    pub(super) fn sees_from_above(&self, middle_px: [f64; 2]) -> bool {
        match self {
            // From columns to rows is clockwise; seen from above, from x to y is counter-clockwise.
            Fit::Plane {
                base_from_pixel, ..
            } => {
                let [u, v] = middle_px;
                let factor = (base_from_pixel * Vector3::new(u, v, 1.0)).z;
                // The sign of the map's local determinant there is that of det(H) / w^3.
                base_from_pixel.determinant() * factor < 0.0
            }
            Fit::Rigid {
                base_from_camera, ..
            } => (base_from_camera.rotation * Vector3::z()).z < 0.0,
        }
    }
}

/// Removes the lens's distortion from a pixel, if the lens is known.
pub(super) fn straightened(lens: Option<&Lens>, pixel: [f64; 2]) -> Option<[f64; 2]> {
    match lens {
        Some(lens) => lens.straightened(pixel),
        None => Some(pixel),
    }
}

fn on_table(
    base_from_pixel: &Matrix3<f64>,
    height: &[f64; 3],
    straight_px: [f64; 2],
) -> Option<Point3<f64>> {
    let [x, y] = through(base_from_pixel, straight_px)?;
    Some(Point3::new(x, y, height_at(height, [x, y])))
}

/// Returns a plane's height at `x`, `y`.
pub(super) fn height_at(height: &[f64; 3], [x, y]: [f64; 2]) -> f64 {
    height[0] + height[1] * x + height[2] * y
}
