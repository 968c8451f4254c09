//! A point of a picture that is known more finely than by its pixel.

use crate::camera::center_of;
use fab_program::PixelPoint;

/// A whole pixel, which prompts and answers name, and the point that it stands for, which is executed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    /// The whole pixel that stands for it in prompts and answers.
    pub pixel: PixelPoint,
    /// Where it was located, `[column, row]` in the camera's pixels; a pixel's centre is at one half.
    pub at: [f64; 2],
}

impl Located {
    /// Takes a point `[column, row]`, and the pixel that holds it.
    pub fn at(at: [f64; 2]) -> Located {
        let [column, row] = at.map(|at| at.floor() as i32);
        Located {
            pixel: PixelPoint::new(column, row),
            at,
        }
    }

    /// Takes a pixel's own centre.
    pub fn at_center_of(pixel: PixelPoint) -> Located {
        Located {
            pixel,
            at: center_of(pixel),
        }
    }
}
