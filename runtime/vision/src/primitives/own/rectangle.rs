//! The smallest rectangle around points, at any angle: one of its sides lies on a side of their hull (Freeman and Shapira
//! 1975).
//!
//! In: pixels. Out: a rectangle through the middles of the outermost pixels.

use crate::VisionError;
use crate::rectangle::Rectangle;
use fab_picture::hull;
use fab_program::PixelPoint;

/// Returns the rectangle of least area around at least one pixel, whose middles are at whole coordinates.
///
/// Of equally small ones, the one along the first side of the hull is taken.
pub fn smallest_rectangle(pixels: &[PixelPoint]) -> Result<Rectangle, VisionError> {
    let points = pixels.iter().map(|at| [f64::from(at.u), f64::from(at.v)]);
    let hull = hull::around(points);
    let mut best = Rectangle {
        center: hull.first().copied().unwrap_or_default(),
        along: [1.0, 0.0],
        sides: [0.0; 2],
    };
    let mut least = f64::INFINITY;
    for (from, to) in hull::edges(&hull).filter(|(from, to)| from != to) {
        let side = hull::minus(to, from);
        let length = hull::dot(side, side).sqrt();
        let along = side.map(|component| component / length);
        let (center, sides) = hull::rectangle(&hull, along);
        let area = sides[0] * sides[1];
        if area < least {
            least = area;
            best = Rectangle {
                center,
                along,
                sides,
            };
        }
    }
    Ok(best)
}
