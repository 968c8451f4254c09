//! A camera over the table: pixel and depth to world, world to pixel.
//!
//! In: the camera's pose and projection, or how its pixels lie on the table. Out: coordinates. World points are metres,
//! right-handed, z up; pixels are `[column, row]` from the top left corner of the image, where column 3 spans 3 to 4
//! and has its centre at 3.5. `fab_vision` decides whether a pixel shows cloth; `fab_arm::calibration` measures the
//! pose of a real camera.

mod lens;
mod pinhole;
mod plane;
#[cfg(test)]
mod tests;

pub use lens::Lens;
pub use pinhole::Pinhole;
pub use plane::{Plane, through};

use fab_program::{ImageUp, PixelPoint};
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

/// A camera that looks at the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// How pixels and world points correspond.
    pub projection: Projection,
    /// Width and height of the image, pixels.
    pub size_px: [u32; 2],
}

/// How pixels and world points correspond.
#[derive(Clone, Debug, PartialEq)]
pub enum Projection {
    /// The camera's pose is known: a pixel is a ray, and a depth gives the distance along it.
    Pinhole {
        /// Camera pose. In the camera's own frame x is image right, y image down, z the optical axis.
        world_from_camera: Isometry3<f64>,
        /// How rays map to pixels.
        lens: Lens,
    },
    /// Only the table's plane is known: every pixel shows the plane's point there, and every point is assumed to lie on
    /// it; depth is ignored.
    Plane(Plane),
}

impl Camera {
    /// Places a camera above the world's origin, looking straight down.
    ///
    /// - `height_m`: of the optical centre above the table.
    /// - `fov_rad`: field of view across the square image, between 0 and pi.
    /// - `image_px`: side of the image.
    /// - `up`: which table axis is up in the image.
    pub fn top_down(height_m: f64, fov_rad: f64, image_px: u32, up: ImageUp) -> Self {
        // A half turn points the camera down. About X it keeps image right at +X; about the diagonal it maps image
        // right to -Y and image down to -X.
        let axis = match up {
            ImageUp::Y => Vector3::x_axis(),
            ImageUp::X => Unit::new_normalize(Vector3::new(1.0, -1.0, 0.0)),
        };
        let half_turn = Rotation3::from_axis_angle(&axis, std::f64::consts::PI);
        let world_from_camera = Isometry3::from_parts(
            Translation3::new(0.0, 0.0, height_m),
            UnitQuaternion::from_rotation_matrix(&half_turn),
        );
        let focal_px = f64::from(image_px) / (2.0 * (fov_rad / 2.0).tan());
        Camera {
            projection: Projection::Pinhole {
                world_from_camera,
                lens: Lens::undistorted([focal_px; 2], [f64::from(image_px) / 2.0; 2]),
            },
            size_px: [image_px; 2],
        }
    }

    /// Projects a world point into the image, `[column, row]`.
    ///
    /// The result may lie outside the image. `None` for points that are not in front of the camera. A plane-only camera
    /// projects every point onto the plane vertically first.
    pub fn pixel_from_world(&self, point: Point3<f64>) -> Option<[f64; 2]> {
        match &self.projection {
            Projection::Pinhole {
                world_from_camera,
                lens,
            } => lens.pixel_from_camera(world_from_camera.inverse_transform_point(&point)),
            Projection::Plane(plane) => plane.pixel_from_world(point),
        }
    }

    /// Returns the world point that a pixel shows at `depth_m`, measured along the optical axis.
    ///
    /// `None` if the depth is not a reading (zero, negative, not finite) or the pixel is not finite. A plane-only
    /// camera ignores the depth and returns the plane's point.
    pub fn world_from_pixel(&self, pixel: [f64; 2], depth_m: f64) -> Option<Point3<f64>> {
        match &self.projection {
            Projection::Pinhole {
                world_from_camera,
                lens,
            } => {
                let seen = lens.camera_from_pixel(pixel, depth_m)?;
                let point = world_from_camera.transform_point(&seen);
                point.iter().all(|value| value.is_finite()).then_some(point)
            }
            Projection::Plane(plane) => plane.world_from_pixel(pixel),
        }
    }

    /// Returns the table point that a pixel shows: at height 0, or on the measured plane.
    ///
    /// `None` if the pixel does not look down at the table.
    pub fn table_from_pixel(&self, pixel: [f64; 2]) -> Option<Point3<f64>> {
        match &self.projection {
            Projection::Pinhole {
                world_from_camera, ..
            } => {
                let on_ray = self.world_from_pixel(pixel, 1.0)?;
                let eye = world_from_camera.translation.vector;
                self.world_from_pixel(pixel, eye.z / (eye.z - on_ray.z))
            }
            Projection::Plane(plane) => plane.world_from_pixel(pixel),
        }
    }

    /// Returns the table direction that corresponds to an image direction at a pixel; its length is that of the image
    /// direction.
    ///
    /// The result is level, because a carried cloth keeps its height. `None` if the pixel does not look down at the
    /// table.
    pub fn table_direction(
        &self,
        at_px: [f64; 2],
        [right, down]: [f64; 2],
    ) -> Option<Vector3<f64>> {
        if let Projection::Pinhole {
            world_from_camera, ..
        } = &self.projection
        {
            let rotation = world_from_camera.rotation;
            // Seen from straight above, the image axes are table axes everywhere in the image.
            if (rotation * Vector3::z() + Vector3::z()).norm() < STRAIGHT_DOWN {
                return Some(rotation * Vector3::new(right, down, 0.0));
            }
        }
        let length = right.hypot(down);
        let step = [right, down].map(|part| part / length / 2.0);
        let ahead = self.table_from_pixel([at_px[0] + step[0], at_px[1] + step[1]])?;
        let behind = self.table_from_pixel([at_px[0] - step[0], at_px[1] - step[1]])?;
        let mut way = ahead - behind;
        way.z = 0.0;
        let way = way.try_normalize(f64::MIN_POSITIVE)? * length;
        way.iter().all(|value| value.is_finite()).then_some(way)
    }
}

/// How far an optical axis may deviate from vertical and still count as vertical, radians: more than rounding.
const STRAIGHT_DOWN: f64 = 1e-9;

/// Returns the centre of a whole pixel, in the coordinates of [`Camera::world_from_pixel`].
pub fn center_of(pixel: PixelPoint) -> [f64; 2] {
    [f64::from(pixel.u) + 0.5, f64::from(pixel.v) + 0.5]
}
