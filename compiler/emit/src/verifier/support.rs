//! The functions that emitted checks call, the same as in `support.py`; without these lines, the end of each module.
//!
//! Each does what one line of `fab_program::eval` does, on the same floats in the same order.

/// Whether every part holds.
fn all<const N: usize>(parts: [bool; N]) -> bool {
    parts.iter().all(|holds| *holds)
}

/// Whether at least one part holds.
fn any<const N: usize>(parts: [bool; N]) -> bool {
    parts.iter().any(|holds| *holds)
}

/// Whether a pixel is one of the points of these keypoints.
fn is_point(scene: &dyn Scene, keypoints: &[&str], pixel: [i32; 2]) -> bool {
    keypoints.iter().any(|keypoint| match scene.points(keypoint) {
        Some(points) => points.contains(&pixel),
        None => false,
    })
}

/// Whether a pixel lies in one of these masks.
fn is_inside(scene: &dyn Scene, masks: &[&str], pixel: [i32; 2]) -> bool {
    masks.iter().any(|mask| match scene.distance_px(mask, pixel) {
        Some(distance) => distance <= 0.0,
        None => false,
    })
}

/// Whether a word is one of the choices.
fn is_word(choices: &[&str], word: &str) -> bool {
    choices.iter().any(|choice| *choice == word)
}

/// Whether a number is one of the choices.
fn is_choice<T>(choices: &[(f64, T)], value: f64) -> bool {
    choices.iter().any(|(choice, _)| *choice == value)
}

/// What a chosen number stands for: metres, or a vector, right and down.
fn chosen<T: Copy>(choices: &[(f64, T)], value: f64, field: &'static str) -> Result<T, Refusal> {
    for (choice, meaning) in choices {
        if *choice == value {
            return Ok(*meaning);
        }
    }
    Err(Refusal::Missing(field))
}

/// The action before this one.
fn known<T>(last: Option<T>) -> Result<T, Refusal> {
    last.ok_or(Refusal::Missing("last"))
}

/// The point of a keypoint.
fn keypoint(scene: &dyn Scene, name: &'static str) -> Result<[f64; 2], Refusal> {
    match scene.points(name) {
        Some([point, ..]) => Ok(at(*point)),
        _ => Err(Refusal::Missing(name)),
    }
}

/// A pixel as floats.
fn at(pixel: [i32; 2]) -> [f64; 2] {
    [f64::from(pixel[0]), f64::from(pixel[1])]
}

/// The point on the other side of another.
fn mirror(of: [f64; 2], about: [f64; 2]) -> [f64; 2] {
    [2.0 * about[0] - of[0], 2.0 * about[1] - of[1]]
}

/// Where a direction and a length lead, pixels.
fn carried(start: [f64; 2], vector: [f64; 2], length_px: f64) -> [f64; 2] {
    [start[0] + vector[0] * length_px, start[1] + vector[1] * length_px]
}

/// The square of a length.
fn square(length: f64) -> f64 {
    length * length
}

/// The square of a number, with its sign.
fn signed_square(value: f64) -> f64 {
    if value < 0.0 { -(value * value) } else { value * value }
}

/// The larger of two numbers.
fn larger(one: f64, other: f64) -> f64 {
    if one > other { one } else { other }
}

/// The direction from one point to another, not of length 1.
fn from_to(start: [f64; 2], end: [f64; 2]) -> [f64; 2] {
    [end[0] - start[0], end[1] - start[1]]
}

/// Whether an angle is less than the one with this cosine.
fn angle_less(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> bool {
    let (along, limit) = angle_sides(a, b, limit_cos);
    along > limit
}

/// Whether an angle is at most the one with this cosine.
fn angle_at_most(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> bool {
    let (along, limit) = angle_sides(a, b, limit_cos);
    along >= limit
}

/// Whether an angle is greater than the one with this cosine.
fn angle_greater(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> bool {
    let (along, limit) = angle_sides(a, b, limit_cos);
    along < limit
}

/// Whether an angle is at least the one with this cosine.
fn angle_at_least(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> bool {
    let (along, limit) = angle_sides(a, b, limit_cos);
    along <= limit
}

/// The cosine of an angle and of its limit, squared with their signs, times both squared lengths.
///
/// The larger an angle, the smaller its cosine. This needs no root and no trigonometry. Sides that differ only by
/// rounding are equal.
fn angle_sides(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> (f64, f64) {
    let along = signed_square(dot(a, b));
    let size = dot(a, a) * dot(b, b);
    let limit = signed_square(limit_cos) * size;
    if (along - limit).abs() <= 1e-12 * size { (limit, limit) } else { (along, limit) }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// How many points a keypoint has.
fn count(scene: &dyn Scene, name: &'static str) -> Result<f64, Refusal> {
    match scene.points(name) {
        Some(points) => Ok(points.len() as f64),
        None => Err(Refusal::Missing(name)),
    }
}

/// How many pixels a mask has.
fn area_px(scene: &dyn Scene, name: &'static str) -> Result<f64, Refusal> {
    scene.area_px(name).ok_or(Refusal::Missing(name))
}

/// How far the nearest pixel of a point is from a mask or box; infinitely far from an empty one.
fn distance_px(scene: &dyn Scene, point: [f64; 2], region: &str) -> f64 {
    let pixel = [whole(point[0]), whole(point[1])];
    scene.distance_px(region, pixel).unwrap_or(f64::INFINITY)
}

/// The nearest whole number; halves go up.
fn whole(value: f64) -> i32 {
    let raised = value + 0.5;
    // The conversion cuts towards zero and stops at the ends of i32.
    let cut = raised as i32;
    if f64::from(cut) > raised && cut > i32::MIN { cut - 1 } else { cut }
}
