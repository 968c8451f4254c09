//! The smallest rectangle around a mask, at any angle.
//!
//! In: a mask. Out: a [`Rectangle`]: the cloth's pose, up to the rectangle's own symmetries.

use super::{VisionError, contour};
use fab_picture::Mask;
use opencv::core::{Point, Vector};
use opencv::imgproc;

/// A rectangle in a picture; points are `[column, row]`, pixels, with pixel centres at one half.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Its middle.
    pub center: [f64; 2],
    /// Unit vector along its longer side.
    pub along: [f64; 2],
    /// Its longer and shorter side, pixels.
    pub sides: [f64; 2],
}

/// Returns the rectangle of least area around a mask's largest piece; `None` if the mask is empty.
///
/// Fails if the mask is larger than a picture may be, or OpenCV fails.
pub fn rectangle_around(mask: &Mask) -> Result<Option<Rectangle>, VisionError> {
    let outline = contour(mask, 0.0)?;
    if outline.is_empty() {
        return Ok(None);
    }
    let points: Vector<Point> = outline.iter().map(|at| Point::new(at.u, at.v)).collect();
    let found = imgproc::min_area_rect(&points)?;
    let angle = f64::from(found.angle).to_radians();
    // The outline runs through the middles of the outermost pixels.
    let [width, height] = [found.size.width, found.size.height].map(|side| f64::from(side) + 1.0);
    let angle = if width < height {
        angle + std::f64::consts::FRAC_PI_2
    } else {
        angle
    };
    Ok(Some(Rectangle {
        center: [found.center.x, found.center.y].map(|at| f64::from(at) + 0.5),
        along: [angle.cos(), angle.sin()],
        sides: [width.max(height), width.min(height)],
    }))
}
