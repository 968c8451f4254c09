//! Upright boxes around masks.
//!
//! In: a mask, or a box as its left-top and right-bottom pixels, both inclusive. Out: boxes, points, distances.

use fab_picture::Mask;
use fab_program::PixelPoint;

/// Returns the left-top and the right-bottom pixel of the smallest upright box around a mask, both inclusive.
///
/// `None` if the mask is empty.
pub fn bounding_box(mask: &Mask) -> Option<[PixelPoint; 2]> {
    let mut pixels = mask.pixels();
    let first = pixels.next()?;
    Some(pixels.fold([first; 2], |[low, high], pixel| {
        [
            PixelPoint::new(low.u.min(pixel.u), low.v.min(pixel.v)),
            PixelPoint::new(high.u.max(pixel.u), high.v.max(pixel.v)),
        ]
    }))
}

/// Returns the middle pixel of a box: `floor((right - left) / 2) + left`, likewise for rows.
///
/// This is the paper's rounding (protocol, section 4, item 3): of two middle pixels, the left or upper one.
pub fn box_center(corners: [PixelPoint; 2]) -> PixelPoint {
    let [low, high] = sorted(corners);
    // `floor((low + high) / 2)` is the same number and cannot overflow in 64 bits.
    let middle = |a: i32, b: i32| (i64::from(a) + i64::from(b)).div_euclid(2) as i32;
    PixelPoint::new(middle(low.u, high.u), middle(low.v, high.v))
}

/// Returns the Euclidean distance from a point to the nearest pixel of a box, pixels; zero in the box.
pub fn box_distance_px(point: PixelPoint, corners: [PixelPoint; 2]) -> f64 {
    let [low, high] = sorted(corners);
    let nearest = PixelPoint::new(point.u.clamp(low.u, high.u), point.v.clamp(low.v, high.v));
    point.distance_px(nearest)
}

/// Returns left-top and right-bottom for any two opposite corners.
pub(super) fn sorted([a, b]: [PixelPoint; 2]) -> [PixelPoint; 2] {
    [
        PixelPoint::new(a.u.min(b.u), a.v.min(b.v)),
        PixelPoint::new(a.u.max(b.u), a.v.max(b.v)),
    ]
}
