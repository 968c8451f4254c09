//! Pick points for a prompt that lists none: where the cloth's outline bends.
//!
//! In: a [`View`]. Out: pixels of the cloth near its convex outline, and the middle of the box around it.

use super::view::{Face, View};
use fab_picture::hull::{self, Point};
use fab_program::PixelPoint;

/// Least distance between points, in sides of the cloth.
const SPACING: f64 = 0.1;

/// How far inside the outline a point is taken, pixels, so that the picker hits cloth.
const INWARD_PX: f64 = 3.0;

/// The most points.
const MAX_POINTS: usize = 15;

/// Returns where the outline bends most, pixels; `edge_px` is the cloth's side.
pub fn corners(view: &View, edge_px: f64) -> Vec<PixelPoint> {
    let hull = hull::around(view.rim());
    let (middle, _) = view.middle();
    // Half the spacing along the outline either way, so that single-pixel steps do not count as bends.
    let reach = SPACING / 2.0 * edge_px;
    let bend = |at: usize| {
        let [before, after] = [
            along(&hull, at, reach, hull.len() - 1),
            along(&hull, at, reach, 1),
        ];
        let between = [0, 1].map(|axis| (before[axis] + after[axis]) / 2.0);
        hull::distance(hull[at], between)
    };
    let mut bends: Vec<(Point, f64)> = (0..hull.len()).map(|at| (hull[at], bend(at))).collect();
    bends.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut kept: Vec<Point> = Vec::new();
    for (at, _) in bends {
        let is_apart = |other: &Point| hull::distance(at, *other) >= SPACING * edge_px;
        if kept.len() < MAX_POINTS && kept.iter().all(is_apart) {
            kept.push(at);
        }
    }
    let inward = |at: Point| {
        let distance_px = hull::distance(at, middle).max(f64::MIN_POSITIVE);
        let share = INWARD_PX.min(distance_px) / distance_px;
        [0, 1].map(|axis| at[axis] + share * (middle[axis] - at[axis]))
    };
    let points = kept.into_iter().map(inward);
    points
        .filter(|&at| view.at(at) != Face::Table)
        .map(|[column, row]| PixelPoint::new(column as i32, row as i32))
        .collect()
}

/// Follows an outline from one of its corners for some pixels; `step` is 1, or one less than the number of corners to
/// go backwards.
fn along(hull: &[Point], from: usize, mut way_px: f64, step: usize) -> Point {
    let mut at = from;
    for _ in 0..hull.len() {
        let next = (at + step) % hull.len();
        let length = hull::distance(hull[at], hull[next]);
        if length >= way_px && length > 0.0 {
            let share = way_px / length;
            return [0, 1].map(|axis| hull[at][axis] + share * (hull[next][axis] - hull[at][axis]));
        }
        way_px -= length;
        at = next;
    }
    hull[at]
}

/// Returns the middle of the upright box around the cloth, pixels.
pub fn center(view: &View) -> Point {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in view.rim() {
        for axis in [0, 1] {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    [0, 1].map(|axis| (low[axis] + high[axis]) / 2.0)
}
