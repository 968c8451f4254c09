//! A pinhole camera: pixel and depth to world, world to pixel.
//!
//! In: where the camera is, how wide it sees. Out: coordinates. World points are metres, right-handed, z up;
//! pixels are `[column, row]` from the top left corner of the image, in which the pixel in column 3 spans 3
//! to 4 and has its centre at 3.5. Whether a pixel shows cloth is `crate::vision`'s business.

use compiler::program::{ImageUp, PixelPoint};
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

/// A pinhole camera without distortion.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Pose. In the camera's own frame x is image right, y image down, z the optical axis.
    pub world_from_camera: Isometry3<f64>,
    /// Distance of the image plane, pixels.
    pub focal_px: f64,
    /// Width and height of the image, pixels; the optical axis meets its middle.
    pub size_px: [u32; 2],
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
            world_from_camera,
            focal_px,
            size_px: [image_px; 2],
        }
    }

    /// Projects a world point into the image, `[column, row]`.
    ///
    /// The result may lie outside the image. `None` for points that are not in front of the camera.
    pub fn pixel_from_world(&self, point: Point3<f64>) -> Option<[f64; 2]> {
        let seen = self.world_from_camera.inverse_transform_point(&point);
        if seen.z <= 0.0 {
            return None;
        }
        let [middle_u, middle_v] = self.middle_px();
        let pixel = [
            middle_u + self.focal_px * seen.x / seen.z,
            middle_v + self.focal_px * seen.y / seen.z,
        ];
        pixel.iter().all(|value| value.is_finite()).then_some(pixel)
    }

    /// Returns the world point that a pixel shows, `depth_m` being measured along the optical axis.
    ///
    /// `None` where the depth is no reading (zero, negative, not finite) or the pixel is not finite.
    pub fn world_from_pixel(&self, [u, v]: [f64; 2], depth_m: f64) -> Option<Point3<f64>> {
        if !(depth_m.is_finite() && depth_m > 0.0) {
            return None;
        }
        let [middle_u, middle_v] = self.middle_px();
        let seen = Point3::new(
            (u - middle_u) * depth_m / self.focal_px,
            (v - middle_v) * depth_m / self.focal_px,
            depth_m,
        );
        let point = self.world_from_camera.transform_point(&seen);
        point.iter().all(|value| value.is_finite()).then_some(point)
    }

    fn middle_px(&self) -> [f64; 2] {
        self.size_px.map(|side| f64::from(side) / 2.0)
    }
}

/// Returns the middle of a whole pixel, as [`Camera::world_from_pixel`] takes it.
pub fn center_of(pixel: PixelPoint) -> [f64; 2] {
    [f64::from(pixel.u) + 0.5, f64::from(pixel.v) + 0.5]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    fn folding() -> Camera {
        Camera::top_down(0.65, 45_f64.to_radians(), 224, ImageUp::Y)
    }

    #[test]
    fn image_right_is_world_x_and_image_up_is_world_y() {
        let camera = folding();
        let [middle_u, middle_v] = camera.pixel_from_world(Point3::origin()).unwrap();
        assert!((middle_u - 112.0).abs() < 1e-9 && (middle_v - 112.0).abs() < 1e-9);
        let [u, v] = camera
            .pixel_from_world(Point3::new(0.1, 0.05, 0.15))
            .unwrap();
        let focal_px = 112.0 / 22.5_f64.to_radians().tan();
        assert!((u - (112.0 + focal_px * 0.1 / 0.5)).abs() < 1e-9, "{u}");
        assert!((v - (112.0 - focal_px * 0.05 / 0.5)).abs() < 1e-9, "{v}");
    }

    #[test]
    fn with_x_up_image_right_is_world_minus_y_and_image_up_is_world_x() {
        let camera = Camera::top_down(1.0, 45_f64.to_radians(), 720, ImageUp::X);
        assert!((camera.focal_px - 869.1169).abs() < 1e-3);
        let point = Point3::new(0.2, 0.1, 0.5);
        let [u, v] = camera.pixel_from_world(point).unwrap();
        // The smoothing camera: u = 360 + f z / (1 - y), v = 360 - f x / (1 - y) with world = (x, -z, y).
        assert!((u - (360.0 - camera.focal_px * 0.1 / 0.5)).abs() < 1e-9);
        assert!((v - (360.0 - camera.focal_px * 0.2 / 0.5)).abs() < 1e-9);
    }

    #[test]
    fn recorded_smoothing_picks_are_seen_where_they_were_recorded() {
        let Some(root) = crate::recorded::recorded_data(
            "recorded_smoothing_picks_are_seen_where_they_were_recorded",
        ) else {
            return;
        };
        let path = root.join("vision/shi_tomasi/manifest.json");
        let manifest: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let camera = Camera::top_down(1.0, 45_f64.to_radians(), 720, ImageUp::X);
        let mut n_points = 0;
        for fixture in manifest["fixtures"].as_array().unwrap() {
            let numbers = |name: &str| -> Option<Vec<f64>> {
                let list = fixture[name].as_array()?;
                Some(list.iter().map(|value| value.as_f64().unwrap()).collect())
            };
            // The recorded pixel was computed from the recorded point, which has y up.
            let (Some(pick), Some(px)) = (numbers("pick_world_m"), numbers("pick_px_from_world"))
            else {
                continue;
            };
            let world = Point3::new(pick[0], -pick[2], pick[1]);
            let [u, v] = camera.pixel_from_world(world).unwrap();
            let off = (u - px[0]).abs().max((v - px[1]).abs());
            assert!(off < 0.06, "{}: off by {off}", fixture["name"]);
            n_points += 1;
        }
        assert!(n_points >= 5, "{n_points} points");
    }

    #[test]
    fn the_middle_of_an_image_that_is_not_square_is_half_its_sides() {
        let camera = Camera {
            size_px: [640, 480],
            ..folding()
        };
        let [u, v] = camera.pixel_from_world(Point3::origin()).unwrap();
        assert!((u - 320.0).abs() < 1e-9 && (v - 240.0).abs() < 1e-9);
    }

    #[test]
    fn points_that_are_not_in_front_of_the_camera_have_no_pixel() {
        let camera = folding();
        for z in [0.65, 0.7, f64::NAN, f64::INFINITY] {
            assert_eq!(
                camera.pixel_from_world(Point3::new(0.0, 0.1, z)),
                None,
                "z = {z}"
            );
        }
    }

    #[test]
    fn a_depth_without_a_reading_has_no_world_point() {
        let camera = folding();
        for depth_m in [0.0, -0.1, f64::NAN, f64::INFINITY] {
            assert_eq!(
                camera.world_from_pixel([10.0, 10.0], depth_m),
                None,
                "depth {depth_m}"
            );
        }
        assert_eq!(camera.world_from_pixel([f64::NAN, 10.0], 0.5), None);
        assert!(camera.world_from_pixel([10.0, 10.0], 0.5).is_some());
    }

    #[test]
    fn recorded_pick_pixels_are_reproduced() {
        let Some(root) = crate::recorded::recorded_data("recorded_pick_pixels_are_reproduced")
        else {
            return;
        };
        let path = root.join("folding120/manifest.json");
        let manifest: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let camera = folding();
        let mut n_points = 0;
        for entry in manifest["entries"].as_array().unwrap() {
            for step in entry["steps"].as_array().unwrap() {
                let number = |list: &str, index: usize| step[list][index].as_f64().unwrap();
                // The recording has y up.
                let world = Point3::new(
                    number("pick_world_m", 0),
                    -number("pick_world_m", 2),
                    number("pick_world_m", 1),
                );
                let [u, v] = camera.pixel_from_world(world).unwrap();
                let (du, dv) = (u - number("pick_px", 0), v - number("pick_px", 1));
                assert!(du.hypot(dv) < 1e-3, "{}: off by {du}, {dv}", entry["dir"]);
                n_points += 1;
            }
        }
        assert!(n_points >= 60, "{n_points} points");
    }

    proptest! {
        #[test]
        fn a_pixel_with_its_depth_leads_back_to_the_world_point(
            height_m in 0.2..3.0_f64,
            fov_rad in 0.2..2.5_f64,
            image_px in 16..2000_u32,
            x in -1.0..1.0_f64,
            y in -1.0..1.0_f64,
            above in 0.0..0.9_f64,
            x_is_up: bool,
        ) {
            let up = if x_is_up { ImageUp::X } else { ImageUp::Y };
            let camera = Camera::top_down(height_m, fov_rad, image_px, up);
            let point = Point3::new(x, y, above * height_m);
            let pixel = camera.pixel_from_world(point).unwrap();
            let back = camera.world_from_pixel(pixel, height_m - point.z).unwrap();
            prop_assert!((back - point).norm() < 1e-9);
        }

        #[test]
        fn any_pose_leads_back_to_the_world_point(
            turn in prop::array::uniform3(-3.0..3.0_f64),
            place in prop::array::uniform3(-1.0..1.0_f64),
            pixel in prop::array::uniform2(0.0..480.0_f64),
            depth_m in 0.05..5.0_f64,
        ) {
            let world_from_camera = Isometry3::new(Vector3::from(place), Vector3::from(turn));
            let camera = Camera { world_from_camera, focal_px: 500.0, size_px: [640, 480] };
            let point = camera.world_from_pixel(pixel, depth_m).unwrap();
            let [u, v] = camera.pixel_from_world(point).unwrap();
            prop_assert!((u - pixel[0]).abs() < 1e-6 && (v - pixel[1]).abs() < 1e-6);
        }
    }
}
