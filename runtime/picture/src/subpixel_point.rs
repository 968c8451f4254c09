//! A picture point located with sub-pixel precision.

use fab_program::PixelPoint;

/// A whole pixel, as prompts and answers name it, and the exact point behind it, which is executed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubpixelPoint {
    /// The whole pixel that prompts and answers name.
    pub pixel: PixelPoint,
    /// The exact point, `[column, row]` in the camera's pixels; a pixel's centre is at one half.
    pub at: [f64; 2],
}

impl SubpixelPoint {
    /// Takes an exact point `[column, row]`, and the pixel that holds it.
    pub fn at(at: [f64; 2]) -> SubpixelPoint {
        let pixel = PixelPoint::from(at.map(|at| at.floor() as i32));
        SubpixelPoint { pixel, at }
    }
}
