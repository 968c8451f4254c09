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
        let across = [-along[1], along[0]];
        let extent = |axis: hull::Point| {
            let each = hull.iter().map(|&point| hull::dot(point, axis));
            each.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
                [low.min(at), high.max(at)]
            })
        };
        let [[left, right], [low, high]] = [extent(along), extent(across)];
        let area = (right - left) * (high - low);
        if area < least {
            let [x, y] = [(left + right) / 2.0, (low + high) / 2.0];
            least = area;
            best = Rectangle {
                center: [0, 1].map(|axis| x * along[axis] + y * across[axis]),
                along,
                sides: [right - left, high - low],
            };
        }
    }
    Ok(best)
}
