//! Outlines of masks as closed polygons, and points on them.
//!
//! In: a mask. Out: the polygon's vertices in order; the last side leads back to the first vertex.

use super::corners::within;
use super::primitives::chosen;
use super::{VisionError, check_size};
use fab_picture::regions;
use fab_picture::{Mask, SubpixelPoint};
use fab_program::PixelPoint;
use std::cmp::Reverse;
use std::collections::BTreeSet;

/// The most points that [`along`] returns.
pub const MAX_ALONG: u32 = 10_000;

/// Returns the outer outline of a mask's largest piece; empty if the mask is.
///
/// Pixels that touch by a side or a corner belong to one piece; of equally large pieces, the one whose first pixel
/// comes first row by row. The outline consists of pixels of the piece and ignores holes.
/// With a `tolerance_px` above 0 it is simplified to a polygon within about that distance (Douglas and Peucker 1973);
/// with 0 every pixel is kept.
///
/// It starts at the topmost, then leftmost vertex, and runs clockwise as seen in the picture. An outline without area,
/// for example of a line one pixel wide, runs forth and back, in either order.
///
/// Fails if the tolerance is not between 0 and 8192, the mask's sides are longer than
/// [`super::MAX_SIDE_PX`].
pub fn contour(mask: &Mask, tolerance_px: f64) -> Result<Vec<PixelPoint>, VisionError> {
    within("tolerance", tolerance_px, 0.0..=8192.0, "0 to 8192")?;
    if mask.is_empty() {
        return Ok(Vec::new());
    }
    check_size(mask.width(), mask.height())?;
    let mut outline = chosen::outer_outline(&largest(mask))?;
    if tolerance_px > 0.0 {
        outline = chosen::simplified(&outline, tolerance_px)?;
    }
    Ok(in_order(outline))
}

/// Returns the mask's largest piece alone; of equally large ones, the one that begins farther up, then farther left.
pub fn largest(mask: &Mask) -> Mask {
    let pieces = regions::components(mask).into_iter();
    // The first of equally large ones, which `max_by_key` would not return.
    let largest = pieces.min_by_key(|piece| Reverse(piece.len()));
    Mask::from_pixels(mask.width(), mask.height(), &largest.unwrap_or_default())
}

/// Rotates a closed polygon's vertices to start at the upper left one and run clockwise.
fn in_order(mut points: Vec<PixelPoint>) -> Vec<PixelPoint> {
    let first = (0..points.len()).min_by_key(|&index| (points[index].v, points[index].u));
    points.rotate_left(first.unwrap_or(0));
    // Rows count downward, so a positive area means clockwise to the eye.
    let doubled_area: i64 = sides(&points)
        .map(|(a, b)| i64::from(a.u) * i64::from(b.v) - i64::from(b.u) * i64::from(a.v))
        .sum();
    if doubled_area < 0 {
        points[1..].reverse();
    }
    points
}

/// Pairs each vertex with the next one, the last one with the first.
fn sides(outline: &[PixelPoint]) -> impl Iterator<Item = (PixelPoint, PixelPoint)> {
    let next = outline.iter().cycle().skip(1);
    outline.iter().copied().zip(next.copied())
}

/// Returns the middle of each side of an outline, in its order; the pixel is rounded, halves up (right and down).
///
/// The two sides of a two-point outline are taken once; a single point has none.
pub fn edge_middles(outline: &[PixelPoint]) -> Vec<SubpixelPoint> {
    let n_sides = match outline.len() {
        0 | 1 => 0,
        2 => 1,
        n => n,
    };
    let pixel = |a: i32, b: i32| (i64::from(a) + i64::from(b) + 1).div_euclid(2) as i32;
    let at = |a: i32, b: i32| (f64::from(a) + f64::from(b) + 1.0) / 2.0;
    sides(outline)
        .take(n_sides)
        .map(|(a, b)| SubpixelPoint {
            pixel: PixelPoint::new(pixel(a.u, b.u), pixel(a.v, b.v)),
            at: [at(a.u, b.u), at(a.v, b.v)],
        })
        .collect()
}

/// Returns points at equal distances along an outline, from its first vertex and in its order.
///
/// At most `count`, and no more than [`MAX_ALONG`]. Each is rounded to a pixel, halves up (right and down), and
/// repeated pixels are dropped, so an outline shorter than `count` pixels has fewer.
pub fn along(outline: &[PixelPoint], count: u32) -> Vec<SubpixelPoint> {
    let count = count.min(MAX_ALONG);
    let perimeter_px: f64 = sides(outline).map(|(a, b)| a.distance_px(b)).sum();
    let mut sides = sides(outline);
    let Some(mut side) = sides.next() else {
        return Vec::new();
    };
    let mut side_begins_px = 0.0;
    let mut points = Vec::with_capacity(count as usize);
    let mut taken = BTreeSet::new();
    for index in 0..count {
        let at_px = perimeter_px * f64::from(index) / f64::from(count);
        while at_px > side_begins_px + side.0.distance_px(side.1) {
            // Rounding may put the last point slightly past the last side; it then stays at its end.
            let Some(next) = sides.next() else { break };
            side_begins_px += side.0.distance_px(side.1);
            side = next;
        }
        let point = on_side(side, at_px - side_begins_px);
        if taken.insert(point.pixel) {
            points.push(point);
        }
    }
    points
}

fn on_side((a, b): (PixelPoint, PixelPoint), from_a_px: f64) -> SubpixelPoint {
    let length_px = a.distance_px(b);
    let fraction = if length_px > 0.0 {
        (from_a_px / length_px).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let at = [(a.u, b.u), (a.v, b.v)]
        .map(|(a, b)| f64::from(a) + fraction * (f64::from(b) - f64::from(a)) + 0.5);
    SubpixelPoint::at(at)
}
