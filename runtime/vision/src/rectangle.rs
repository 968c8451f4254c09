//! The smallest rectangle around a mask, at any angle.
//!
//! In: a mask. Out: a [`Rectangle`]: the cloth's pose, up to the rectangle's own symmetries.

use super::primitives::chosen;
use super::{VisionError, contour};
use fab_picture::Mask;

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

impl Rectangle {
    /// Returns the point at these shares of the longer and the shorter side from the middle.
    pub fn point(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        let (along, [longer, shorter]) = (self.along, self.sides);
        let across = [-along[1], along[0]];
        [0, 1].map(|axis| self.center[axis] + s * longer * along[axis] + t * shorter * across[axis])
    }
}

/// Returns the rectangle of least area around a mask's largest piece; `None` if the mask is empty.
///
/// Fails if the mask is larger than a picture may be.
pub fn rectangle_around(mask: &Mask) -> Result<Option<Rectangle>, VisionError> {
    let outline = contour(mask, 0.0)?;
    if outline.is_empty() {
        return Ok(None);
    }
    let found = chosen::smallest_rectangle(&outline)?;
    // The outline runs through the middles of the outermost pixels.
    let [along_px, across_px] = found.sides.map(|side| side + 1.0);
    let [x, y] = found.along;
    let is_across = along_px < across_px;
    Ok(Some(Rectangle {
        center: found.center.map(|at| at + 0.5),
        along: if is_across { [-y, x] } else { [x, y] },
        sides: [along_px.max(across_px), along_px.min(across_px)],
    }))
}
