//! The camera, and the pixels in which a task gives its points.

use crate::words::words;
use serde::{Deserialize, Serialize};

/// A camera that looks straight down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Height of the optical centre above the table, metres.
    pub height_m: f64,
    /// Field of view across the square image, radians.
    pub fov_rad: f64,
    /// Side of the square image, pixels.
    pub image_px: u32,
    /// Which table direction is up in the image.
    pub up: ImageUp,
}

impl Camera {
    /// Returns the pixels in one metre on the table.
    pub fn px_per_m(&self) -> f64 {
        f64::from(self.image_px) / (2.0 * libm::tan(self.fov_rad / 2.0) * self.height_m)
    }
}

/// Which table direction is up in an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ImageUp {
    /// World +Y, so that image right is +X (the paper's folding).
    Y,
    /// World +X, so that image right is -Y (the paper's smoothing).
    X,
}

words! { ImageUp {
    "x" => X, "the table's x axis is up in the picture, and y to the left";
    "y" => Y, "the table's y axis is up in the picture, and x to the right";
} }

/// A whole pixel of the camera image: column from the left, row from the top, written `[u, v]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(from = "[i32; 2]", into = "[i32; 2]")]
pub struct PixelPoint {
    /// Column.
    pub u: i32,
    /// Row.
    pub v: i32,
}

impl PixelPoint {
    /// Makes a pixel from column and row.
    pub const fn new(u: i32, v: i32) -> Self {
        PixelPoint { u, v }
    }

    /// Returns the Euclidean distance to another pixel, pixels.
    pub fn distance_px(self, other: PixelPoint) -> f64 {
        let du = f64::from(self.u) - f64::from(other.u);
        let dv = f64::from(self.v) - f64::from(other.v);
        (du * du + dv * dv).sqrt()
    }
}

impl From<[i32; 2]> for PixelPoint {
    fn from([u, v]: [i32; 2]) -> Self {
        PixelPoint { u, v }
    }
}

impl From<PixelPoint> for [i32; 2] {
    fn from(point: PixelPoint) -> Self {
        [point.u, point.v]
    }
}

impl std::fmt::Display for PixelPoint {
    /// Writes `(u, v)`, the form in prompts and answers.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({}, {})", self.u, self.v)
    }
}
