//! The camera model of the square picture that tasks see.
//!
//! In: a calibration, the pose of the world frame, the window. Out: a [`Camera`]. Cutting and scaling the picture is
//! left to the world that takes it.

use super::Calibration;
use super::fit::height_at;
use fab_picture::camera::{Camera, Plane, Projection};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use serde::{Deserialize, Serialize};

/// The square of the camera's own picture that tasks see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "[u32; 3]", into = "[u32; 3]")]
pub struct Window {
    /// Its left edge, pixels of the camera's own picture.
    pub left_px: u32,
    /// Its top edge.
    pub top_px: u32,
    /// Its side length.
    pub side_px: u32,
}

impl From<[u32; 3]> for Window {
    /// From left, top and side.
    fn from([left_px, top_px, side_px]: [u32; 3]) -> Window {
        Window {
            left_px,
            top_px,
            side_px,
        }
    }
}

impl From<Window> for [u32; 3] {
    fn from(window: Window) -> [u32; 3] {
        [window.left_px, window.top_px, window.side_px]
    }
}

impl Window {
    /// Returns the pixel of the camera's own picture at fractions of the window's sides, from its top left.
    pub fn pixel_at(&self, [right, down]: [f64; 2]) -> [f64; 2] {
        let side = f64::from(self.side_px);
        [
            f64::from(self.left_px) + right * side,
            f64::from(self.top_px) + down * side,
        ]
    }

    /// Returns the pixels of a grid over it, row by row: the best places to touch.
    ///
    /// The outermost are a tenth of the side from the border, so that the fingertips around them are visible.
    pub fn grid(&self, [columns, rows]: [u32; 2]) -> Vec<[f64; 2]> {
        let share = |index: u32, n: u32| match n {
            0 | 1 => 0.5,
            _ => 0.1 + 0.8 * f64::from(index) / f64::from(n - 1),
        };
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let pixel = |(column, row)| {
            let pixel = self.pixel_at([share(column, columns), share(row, rows)]);
            pixel.map(f64::round)
        };
        places.map(pixel).collect()
    }

    /// Returns whether it has a nonzero side and lies in a picture of this size.
    pub fn is_in(&self, size_px: [u32; 2]) -> bool {
        let ends = |start: u32| start.checked_add(self.side_px);
        let fits = |start, size| ends(start).is_some_and(|end| end <= size);
        self.side_px > 0 && fits(self.left_px, size_px[0]) && fits(self.top_px, size_px[1])
    }

    /// Fails if it does not lie in a picture of this size.
    pub fn check_in(&self, size_px: [u32; 2]) -> Result<(), String> {
        if self.is_in(size_px) {
            return Ok(());
        }
        let ([left, top, side], [width, height]) = (<[u32; 3]>::from(*self), size_px);
        Err(format!(
            "the window `{left}, {top}, {side}` does not lie in the camera's picture of {width} x {height} px; its left and \
             its side come to {width} at the most, its top and its side to {height}"
        ))
    }
}

impl Calibration {
    /// Returns the camera of the square picture that is cropped from the camera's own and scaled, in the world frame.
    ///
    /// - `world_from_base`: pose of the arm's base in the world, which has z up and its origin on the table.
    /// - `image_px`: side of the square picture; it shows the window from edge to edge.
    pub fn camera(
        &self,
        world_from_base: &Isometry3<f64>,
        window: &Window,
        image_px: u32,
    ) -> Camera {
        let scale = f64::from(image_px) / f64::from(window.side_px);
        let origin = [f64::from(window.left_px), f64::from(window.top_px)];
        let Plane {
            world_from_pixel: base_from_pixel,
            height,
            lens,
        } = &self.fit;
        let back = 1.0 / scale;
        let raw_from_square =
            Matrix3::new(back, 0.0, origin[0], 0.0, back, origin[1], 0.0, 0.0, 1.0);
        let projection = Projection::Plane(Plane {
            world_from_pixel: level(world_from_base, height) * base_from_pixel * raw_from_square,
            height: moved(world_from_base, height),
            lens: lens.map(|lens| lens.cut(origin, scale)),
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

/// From `(x, y, 1)` of a plane in the base frame to `(x, y, 1)` in the world's.
fn level(world_from_base: &Isometry3<f64>, height: &[f64; 3]) -> Matrix3<f64> {
    let turn = world_from_base.rotation.to_rotation_matrix();
    let shift = world_from_base.translation.vector;
    let on_plane = Matrix3::new(
        1.0, 0.0, 0.0, //
        0.0, 1.0, 0.0, //
        height[1], height[2], height[0],
    );
    let mut level = turn.matrix() * on_plane;
    for axis in 0..2 {
        level[(axis, 2)] += shift[axis];
    }
    level.set_row(2, &Vector3::z().transpose());
    level
}

/// Converts a plane from the base frame to the world frame.
fn moved(world_from_base: &Isometry3<f64>, height: &[f64; 3]) -> [f64; 3] {
    let normal = world_from_base.rotation * Vector3::new(-height[1], -height[2], 1.0);
    let on_it = world_from_base.transform_point(&Point3::new(0.0, 0.0, height[0]));
    let (along_x, along_y) = (-normal.x / normal.z, -normal.y / normal.z);
    [
        on_it.z - along_x * on_it.x - along_y * on_it.y,
        along_x,
        along_y,
    ]
}
