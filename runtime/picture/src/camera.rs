//! A camera over the table: pixel and depth to world, world to pixel.
//!
//! In: where the camera is and how it projects, or how its pixels lie on the table. Out: coordinates. World points are
//! metres, right-handed, z up; pixels are `[column, row]` from the top left corner of the image, in which the pixel in
//! column 3 spans 3 to 4 and has its centre at 3.5. Whether a pixel shows cloth is `fab_vision`'s business, how the
//! place of a real camera is measured that of `fab_arm::calibration`.

mod lens;
mod pinhole;
mod plane;
#[cfg(test)]
mod tests;

pub use lens::Lens;
pub use pinhole::Pinhole;
pub use plane::Plane;
pub use plane::through;

use fab_program::{ImageUp, PixelPoint};
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

/// A camera that looks at the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// How pixels and points belong together.
    pub projection: Projection,
    /// Width and height of the image, pixels.
    pub size_px: [u32; 2],
}

/// How pixels and points belong together.
#[derive(Clone, Debug, PartialEq)]
pub enum Projection {
    /// The camera's place is known: a pixel is a ray, and a depth says how far along it the point is.
    Pinhole {
        /// Pose. In the camera's own frame x is image right, y image down, z the optical axis.
        world_from_camera: Isometry3<f64>,
        /// What is between a ray and its pixel.
        lens: Lens,
    },
    /// Only the table's plane is known: every pixel shows the point of the plane there, and every point is taken to
    /// lie on it; depth is left aside.
    Plane(Plane),
}

impl Camera {
    /// Places a camera above the world's origin that looks straight down.
    ///
    /// - `height_m`: of the optical centre above the table.
    /// - `fov_rad`: field of view across the square image, between 0 and pi.
    /// - `image_px`: side of the image.
    /// - `up`: which way of the table is up in it.
    pub fn top_down(height_m: f64, fov_rad: f64, image_px: u32, up: ImageUp) -> Self {
        // A half turn points the camera down; about X it leaves right at +X, about the diagonal it takes right
        // to -Y and down to -X.
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
    /// The result may lie outside the image. `None` for points that are not in front of the camera. A camera of which
    /// only the plane is known shows every point where it shows the one of the plane below it.
    pub fn pixel_from_world(&self, point: Point3<f64>) -> Option<[f64; 2]> {
        match &self.projection {
            Projection::Pinhole {
                world_from_camera,
                lens,
            } => lens.pixel_from_camera(world_from_camera.inverse_transform_point(&point)),
            Projection::Plane(plane) => plane.pixel_from_world(point),
        }
    }

    /// Returns the world point that a pixel shows, `depth_m` being measured along the optical axis.
    ///
    /// `None` where the depth is no reading (zero, negative, not finite) or the pixel is not finite. A camera of which
    /// only the plane is known returns the point of the plane, whatever the depth.
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

    /// Returns the point of the table that a pixel shows: at height 0, or on the plane that was measured.
    ///
    /// `None` where the pixel does not look down at the table.
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

    /// Returns which way of the table a way in the image is, at a pixel; as long as the way in the image.
    ///
    /// Level, for what is carried along it keeps its height. `None` where the pixel does not look down at the table.
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
            // The axes of an image that is seen from straight above are ways of the table, everywhere in it.
            if (rotation * Vector3::z() + Vector3::z()).norm() < STRAIGHT_DOWN {
                return Some(rotation * Vector3::new(right, down, 0.0));
            }
        }
        let length = right.hypot(down);
        let step = [right, down].map(|part| part / length / 2.0);
        let ahead = self.table_from_pixel([at_px[0] + step[0], at_px[1] + step[1]])?;
        let behind = self.table_from_pixel([at_px[0] - step[0], at_px[1] - step[1]])?;
        let way = Vector3::new(ahead.x - behind.x, ahead.y - behind.y, 0.0);
        let way = way.try_normalize(f64::MIN_POSITIVE)? * length;
        way.iter().all(|value| value.is_finite()).then_some(way)
    }
}

/// How far from straight down an optical axis may be and count as straight down, radians: more than rounding.
const STRAIGHT_DOWN: f64 = 1e-9;

/// Returns the middle of a whole pixel, as [`Camera::world_from_pixel`] takes it.
pub fn center_of(pixel: PixelPoint) -> [f64; 2] {
    [f64::from(pixel.u) + 0.5, f64::from(pixel.v) + 0.5]
}
