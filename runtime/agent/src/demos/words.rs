//! Describes a demonstrated fold in terms of the picture, so that the words hold for a turned cloth.

use fab_program::{ClothPoint, PixelPoint};

/// The direction of a point from the middle of the picture, counter-clockwise from the right.
const DIRECTIONS: [&str; 8] = [
    "right",
    "top right",
    "top",
    "top left",
    "left",
    "bottom left",
    "bottom",
    "bottom right",
];

/// A point of a fold, with its position in the picture.
#[derive(Clone, Copy)]
pub(super) struct NamedPoint<'a> {
    pub point: &'a ClothPoint,
    pub at: PixelPoint,
}

/// Describes a fold in a sentence without its full stop, e.g. `Pick the corner at the top left and place it on the
/// center of the cloth`.
///
/// - `center`: the middle of the cloth in the picture of the start.
pub(super) fn instruction(
    pick: NamedPoint<'_>,
    place: NamedPoint<'_>,
    center: PixelPoint,
) -> String {
    format!(
        "Pick {} and place it on {}",
        noun(pick, center),
        noun(place, center)
    )
}

/// Describes why the two points were chosen.
pub(super) fn reason(pick: NamedPoint<'_>, place: NamedPoint<'_>, center: PixelPoint) -> String {
    format!(
        "Of the listed points {} is {}, and {} is {}.",
        pick.at,
        noun(pick, center),
        place.at,
        noun(place, center)
    )
}

fn noun(named: NamedPoint<'_>, center: PixelPoint) -> String {
    let on_side = |fraction: f64| fraction == 0.0 || fraction == 1.0;
    let kind = match *named.point {
        ClothPoint::Center => return "the center of the cloth".to_owned(),
        ClothPoint::Particle { right, front } => match (on_side(right), on_side(front)) {
            (true, true) => "corner",
            (true, false) | (false, true) => "edge point",
            (false, false) => "point",
        },
    };
    format!("the {kind} at the {}", direction(named.at, center))
}

/// Returns the closest of the eight directions from one pixel to another.
fn direction(to: PixelPoint, from: PixelPoint) -> &'static str {
    let (right, up) = (f64::from(to.u - from.u), f64::from(from.v - to.v));
    let eighths = (up.atan2(right) / std::f64::consts::FRAC_PI_4).round();
    // From -4 to 4; both ends are the left.
    DIRECTIONS[(eighths as i64).rem_euclid(8) as usize]
}

#[cfg(test)]
#[path = "tests/words.rs"]
mod tests;
