//! The small functions that emitted Rust checks are made of.
//!
//! Each does what one line of [`fab_program::eval`] does, on the same floats in the same order.

/// By name; [`super::python_helpers`] has the same ones.
pub(super) const HELPERS: &[(&str, &str)] = &[
    (
        "all",
        "\
/// Whether every part holds.
fn all<const N: usize>(parts: [bool; N]) -> bool {
    parts.iter().all(|holds| *holds)
}
",
    ),
    (
        "any",
        "\
/// Whether at least one part holds.
fn any<const N: usize>(parts: [bool; N]) -> bool {
    parts.iter().any(|holds| *holds)
}
",
    ),
    (
        "is_point",
        "\
/// Whether a pixel is one of the points of these keypoints.
fn is_point(facts: &Facts<'_>, keypoints: &[&str], point: [i32; 2]) -> bool {
    keypoints.iter().any(|keypoint| match facts.scene.points(keypoint) {
        Some(points) => points.contains(&point),
        None => false,
    })
}
",
    ),
    (
        "is_inside",
        "\
/// Whether a pixel lies in one of these masks.
fn is_inside(facts: &Facts<'_>, masks: &[&'static str], point: [i32; 2]) -> bool {
    masks.iter().any(|mask| match facts.scene.distance_px(mask, point) {
        Some(distance) => distance <= 0.0,
        None => false,
    })
}
",
    ),
    (
        "is_word",
        "\
/// Whether a word is one of the choices.
fn is_word(choices: &[&str], word: &str) -> bool {
    choices.iter().any(|choice| *choice == word)
}
",
    ),
    (
        "is_choice",
        "\
/// Whether a number is one of the choices.
fn is_choice<T>(choices: &[(f64, T)], value: f64) -> bool {
    choices.iter().any(|(choice, _)| *choice == value)
}
",
    ),
    (
        "chosen",
        "\
/// What a chosen number stands for.
fn chosen<T: Copy>(choices: &[(f64, T)], value: f64, field: &'static str) -> Result<T, Refusal> {
    for (choice, meaning) in choices {
        if *choice == value {
            return Ok(*meaning);
        }
    }
    Err(Refusal::Missing(field))
}
",
    ),
    (
        "last",
        "\
/// The action before this one.
fn last<'a>(facts: &Facts<'a>) -> Result<&'a Last, Refusal> {
    facts.last.ok_or(Refusal::Missing(\"last\"))
}
",
    ),
    (
        "keypoint",
        "\
/// The point of a keypoint.
fn keypoint(facts: &Facts<'_>, name: &'static str) -> Result<[f64; 2], Refusal> {
    match facts.scene.points(name) {
        Some([point, ..]) => Ok(at(*point)),
        _ => Err(Refusal::Missing(name)),
    }
}
",
    ),
    (
        "at",
        "\
/// A pixel as floats.
fn at(pixel: [i32; 2]) -> [f64; 2] {
    [f64::from(pixel[0]), f64::from(pixel[1])]
}
",
    ),
    (
        "mirror",
        "\
/// The point on the other side of another.
fn mirror(of: [f64; 2], about: [f64; 2]) -> [f64; 2] {
    [2.0 * about[0] - of[0], 2.0 * about[1] - of[1]]
}
",
    ),
    (
        "carried",
        "\
/// Where a direction and a length lead, pixels.
fn carried(from: [f64; 2], vector: [f64; 2], length_px: f64) -> [f64; 2] {
    [from[0] + vector[0] * length_px, from[1] + vector[1] * length_px]
}
",
    ),
    (
        "square",
        "\
/// The square of a length.
fn square(length: f64) -> f64 {
    length * length
}
",
    ),
    (
        "distance_squared",
        "\
/// The square of the distance between two points.
fn distance_squared(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (du, dv) = (a[0] - b[0], a[1] - b[1]);
    du * du + dv * dv
}
",
    ),
    (
        "chebyshev_squared",
        "\
/// The square of the larger of the distances between two points along the axes.
fn chebyshev_squared(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (du, dv) = (a[0] - b[0], a[1] - b[1]);
    let (du, dv) = (du * du, dv * dv);
    if du > dv { du } else { dv }
}
",
    ),
    (
        "from_to",
        "\
/// The direction from one point to another, not of length 1.
fn from_to(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    [to[0] - from[0], to[1] - from[1]]
}
",
    ),
    (
        "angle_less",
        "\
/// Whether an angle is less than the one with this cosine.
fn angle_less(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> bool {
    let (along, limit) = angle_sides(a, b, limit_cos);
    along > limit
}
",
    ),
    (
        "angle_at_most",
        "\
/// Whether an angle is at most the one with this cosine.
fn angle_at_most(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> bool {
    let (along, limit) = angle_sides(a, b, limit_cos);
    along >= limit
}
",
    ),
    (
        "angle_greater",
        "\
/// Whether an angle is greater than the one with this cosine.
fn angle_greater(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> bool {
    let (along, limit) = angle_sides(a, b, limit_cos);
    along < limit
}
",
    ),
    (
        "angle_at_least",
        "\
/// Whether an angle is at least the one with this cosine.
fn angle_at_least(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> bool {
    let (along, limit) = angle_sides(a, b, limit_cos);
    along <= limit
}
",
    ),
    (
        "angle_sides",
        "\
/// The cosine of an angle and of its limit, squared with their signs, times both squared lengths.
///
/// The larger an angle, the smaller its cosine. This needs no root and no trigonometry.
fn angle_sides(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> (f64, f64) {
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let signed_square = |x: f64| if x < 0.0 { -(x * x) } else { x * x };
    let along = signed_square(dot(a, b));
    (along, signed_square(limit_cos) * (dot(a, a) * dot(b, b)))
}
",
    ),
    (
        "count",
        "\
/// How many points a keypoint has.
fn count(facts: &Facts<'_>, name: &'static str) -> Result<f64, Refusal> {
    match facts.scene.points(name) {
        Some(points) => Ok(points.len() as f64),
        None => Err(Refusal::Missing(name)),
    }
}
",
    ),
    (
        "area_px",
        "\
/// How many pixels a mask has.
fn area_px(facts: &Facts<'_>, name: &'static str) -> Result<f64, Refusal> {
    facts.scene.area_px(name).ok_or(Refusal::Missing(name))
}
",
    ),
    (
        "distance_px",
        "\
/// How far the nearest pixel of a point is from a mask or box; infinitely far from an empty one.
fn distance_px(facts: &Facts<'_>, point: [f64; 2], region: &'static str) -> f64 {
    let pixel = [whole(point[0]), whole(point[1])];
    facts.scene.distance_px(region, pixel).unwrap_or(f64::INFINITY)
}
",
    ),
    (
        "whole",
        "\
/// The nearest whole number; halves go up.
fn whole(value: f64) -> i32 {
    let raised = value + 0.5;
    // The conversion cuts towards zero and stops at the ends of i32.
    let cut = raised as i32;
    if f64::from(cut) > raised && cut > i32::MIN {
        cut - 1
    } else {
        cut
    }
}
",
    ),
];
