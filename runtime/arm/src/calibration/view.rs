//! The camera model of the square picture that tasks see.
//!
//! In: a calibration, the pose of the world frame, the window `[left, top, side]` in pixels of the camera's own picture.
//! Out: a [`Camera`]. Cutting and scaling the picture is left to the world that takes it.

use super::Calibration;
use super::fit::height_at;
use fab_picture::camera::{Camera, Plane, Projection};
use nalgebra::{Isometry3, Matrix3, Matrix4x3, Point3};

/// Returns the pixel of the camera's own picture at fractions of the window's sides, from its top left.
pub(super) fn pixel_at([left, top, side]: [u32; 3], [right, down]: [f64; 2]) -> [f64; 2] {
    let [left, top, side] = [left, top, side].map(f64::from);
    [left + right * side, top + down * side]
}

/// Fails if a window does not lie in a picture of this size.
pub fn check_window([left, top, side]: [u32; 3], [width, height]: [u32; 2]) -> Result<(), String> {
    let fits = |start: u32, size| start.checked_add(side).is_some_and(|end| end <= size);
    if side > 0 && fits(left, width) && fits(top, height) {
        return Ok(());
    }
    Err(format!(
        "the window `{left}, {top}, {side}` does not lie in the camera's picture of {width} x {height} px; its left and its \
         side come to {width} at the most, its top and its side to {height}"
    ))
}

impl Calibration {
    /// Returns the camera of the square picture that is cropped from the camera's own and scaled, in the world frame.
    ///
    /// - `world_from_base`: pose of the arm's base in the world, which has z up and its origin on the table.
    /// - `window`: the square, which the picture shows from edge to edge.
    /// - `image_px`: side of the square picture.
    pub fn camera(
        &self,
        world_from_base: &Isometry3<f64>,
        [left, top, side]: [u32; 3],
        image_px: u32,
    ) -> Camera {
        let scale = f64::from(image_px) / f64::from(side);
        let (back, origin) = (1.0 / scale, [left, top].map(f64::from));
        let raw_from_square =
            Matrix3::new(back, 0.0, origin[0], 0.0, back, origin[1], 0.0, 0.0, 1.0);
        let [level, along_x, along_y] = self.fit.height;
        let on_plane = Matrix4x3::new(
            1.0, 0.0, 0.0, //
            0.0, 1.0, 0.0, //
            along_x, along_y, level, //
            0.0, 0.0, 1.0,
        );
        // From `(x, y, 1)` in the base frame to a point of the plane in the world's.
        let world_from_level = world_from_base.to_homogeneous() * on_plane;
        let across = world_from_level.remove_row(2);
        let upright = across
            .try_inverse()
            .expect("the base does not lie on its side");
        let height = world_from_level.row(2) * upright;
        let projection = Projection::Plane(Plane {
            world_from_pixel: across * self.fit.world_from_pixel * raw_from_square,
            height: [height[2], height[0], height[1]],
            lens: self.fit.lens.map(|lens| lens.cut(origin, scale)),
        });
        Camera {
            projection,
            size_px: [image_px; 2],
        }
    }

    /// Returns the point of the table that a pixel of the camera's own picture shows, metres, base frame.
    pub fn table_from_pixel(&self, pixel: [f64; 2]) -> Option<Point3<f64>> {
        self.fit.world_from_pixel(pixel)
    }

    /// Returns the table's height at a place, metres, base frame: the tool's height when the fingertips touch it.
    pub fn table_height_m(&self, place: [f64; 2]) -> f64 {
        height_at(&self.fit.height, place)
    }
}
