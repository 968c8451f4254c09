//! The small functions that emitted checks are made of, in Rust and in Python side by side.
//!
//! Each does what one line of [`fab_program::eval`] or [`fab_program::measures`] does, on the same floats in the same
//! order. Python's whole numbers become floats first, because its integers never round. The helper of a length in
//! pixels between points, such as `distance`, is named after it, with `_squared` added: see [`of_measure`].

use crate::error::EmitError;
use std::collections::BTreeSet;

/// A helper function.
pub(super) struct Helper {
    /// Its name; in Python with `_` in front.
    pub name: &'static str,
    /// The helpers that it calls, in both languages.
    calls: &'static [&'static str],
    /// Its text in Rust; empty if only Python needs it.
    pub rust: &'static str,
    /// Its text in Python; empty if only Rust needs it.
    pub python: &'static str,
}

/// A helper for a coordinate, the side of the picture from which it counts, and its index.
macro_rules! coordinate_squared {
    ($axis:literal, $side:literal, $index:literal) => {
        Helper {
            name: concat!($axis, "_squared"),
            calls: &["signed_square"],
            rust: concat!(
                "/// The square of a point's distance from the ",
                $side,
                " of the picture; negative beyond it.\n",
                "fn ",
                $axis,
                "_squared(point: [f64; 2]) -> f64 {\n",
                "    signed_square(point[",
                $index,
                "])\n",
                "}\n",
            ),
            python: concat!(
                "def _",
                $axis,
                "_squared(point):\n",
                "    \"\"\"The square of a point's distance from the ",
                $side,
                " of the picture; negative beyond it.\"\"\"\n",
                "    return _signed_square(point[",
                $index,
                "])\n",
            ),
        }
    };
}

/// A helper that compares an angle with a limit, and the sign by which their cosines compare.
macro_rules! angle {
    ($name:literal, $words:literal, $sign:literal) => {
        Helper {
            name: concat!("angle_", $name),
            calls: &["angle_sides"],
            rust: concat!(
                "/// Whether an angle is ",
                $words,
                " the one with this cosine.\n",
                "fn angle_",
                $name,
                "(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> bool {\n",
                "    let (along, limit) = angle_sides(a, b, limit_cos);\n",
                "    along ",
                $sign,
                " limit\n",
                "}\n",
            ),
            python: concat!(
                "def _angle_",
                $name,
                "(a, b, limit_cos):\n",
                "    \"\"\"Whether an angle is ",
                $words,
                " the one with this cosine.\"\"\"\n",
                "    along, limit = _angle_sides(a, b, limit_cos)\n",
                "    return along ",
                $sign,
                " limit\n",
            ),
        }
    };
}

/// Every helper, in the order in which they are written.
pub(super) const HELPERS: &[Helper] = &[
    Helper {
        name: "all",
        calls: &[],
        rust: "\
/// Whether every part holds.
fn all<const N: usize>(parts: [bool; N]) -> bool {
    parts.iter().all(|holds| *holds)
}
",
        python: "",
    },
    Helper {
        name: "any",
        calls: &[],
        rust: "\
/// Whether at least one part holds.
fn any<const N: usize>(parts: [bool; N]) -> bool {
    parts.iter().any(|holds| *holds)
}
",
        python: "",
    },
    Helper {
        name: "is_point",
        calls: &["points", "pixel"],
        rust: "\
/// Whether a pixel is one of the points of these keypoints.
fn is_point(facts: &Facts<'_>, keypoints: &[&str], point: [i32; 2]) -> bool {
    keypoints.iter().any(|keypoint| match facts.scene.points(keypoint) {
        Some(points) => points.contains(&point),
        None => false,
    })
}
",
        python: "\
def _is_point(facts, keypoints, point):
    \"\"\"Whether a pixel is one of the points of these keypoints.\"\"\"
    wanted = _pixel(point)
    return any(
        wanted == _pixel(offered)
        for keypoint in keypoints
        for offered in (_points(facts, keypoint) or ())
    )
",
    },
    Helper {
        name: "is_inside",
        calls: &["pixel"],
        rust: "\
/// Whether a pixel lies in one of these masks.
fn is_inside(facts: &Facts<'_>, masks: &[&'static str], point: [i32; 2]) -> bool {
    masks.iter().any(|mask| match facts.scene.distance_px(mask, point) {
        Some(distance) => distance <= 0.0,
        None => false,
    })
}
",
        python: "\
def _is_inside(facts, masks, point):
    \"\"\"Whether a pixel lies in one of these masks.\"\"\"
    distances = [facts.scene.distance_px(mask, _pixel(point)) for mask in masks]
    return any(distance is not None and distance <= 0.0 for distance in distances)
",
    },
    Helper {
        name: "is_word",
        calls: &[],
        rust: "\
/// Whether a word is one of the choices.
fn is_word(choices: &[&str], word: &str) -> bool {
    choices.iter().any(|choice| *choice == word)
}
",
        python: "\
def _is_word(choices, word):
    \"\"\"Whether a word is one of the choices.\"\"\"
    return any(choice == word for choice in choices)
",
    },
    Helper {
        name: "is_choice",
        calls: &[],
        rust: "\
/// Whether a number is one of the choices.
fn is_choice<T>(choices: &[(f64, T)], value: f64) -> bool {
    choices.iter().any(|(choice, _)| *choice == value)
}
",
        python: "\
def _is_choice(choices, value):
    \"\"\"Whether a number is one of the choices.\"\"\"
    return any(choice == value for choice, _ in choices)
",
    },
    Helper {
        name: "chosen",
        calls: &[],
        rust: "\
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
        python: "\
def _chosen(choices, value, field):
    \"\"\"What a chosen number stands for.\"\"\"
    for choice, meaning in choices:
        if choice == value:
            return meaning
    raise Missing(field)
",
    },
    Helper {
        name: "last",
        calls: &[],
        rust: "\
/// The action before this one.
fn last<'a>(facts: &Facts<'a>) -> Result<&'a Last, Refusal> {
    facts.last.ok_or(Refusal::Missing(\"last\"))
}
",
        python: "\
def _last(facts):
    \"\"\"The action before this one.\"\"\"
    if facts.last is None:
        raise Missing(\"last\")
    return facts.last
",
    },
    Helper {
        name: "keypoint",
        calls: &["points", "at"],
        rust: "\
/// The point of a keypoint.
fn keypoint(facts: &Facts<'_>, name: &'static str) -> Result<[f64; 2], Refusal> {
    match facts.scene.points(name) {
        Some([point, ..]) => Ok(at(*point)),
        _ => Err(Refusal::Missing(name)),
    }
}
",
        python: "\
def _keypoint(facts, name):
    \"\"\"The point of a keypoint.\"\"\"
    points = _points(facts, name)
    if not points:
        raise Missing(name)
    return _at(points[0])
",
    },
    Helper {
        name: "points",
        calls: &[],
        rust: "",
        python: "\
def _points(facts, name):
    \"\"\"The points of a keypoint as a list; None where there is none of that name.\"\"\"
    points = facts.scene.points(name)
    return None if points is None else list(points)
",
    },
    Helper {
        name: "at",
        calls: &["pixel"],
        rust: "\
/// A pixel as floats.
fn at(pixel: [i32; 2]) -> [f64; 2] {
    [f64::from(pixel[0]), f64::from(pixel[1])]
}
",
        python: "\
def _at(point):
    \"\"\"A pixel as floats; whole numbers of Python never round, and floats must.\"\"\"
    column, row = _pixel(point)
    return (float(column), float(row))
",
    },
    Helper {
        name: "pixel",
        calls: &[],
        rust: "",
        python: "\
def _pixel(point):
    \"\"\"A pixel as a pair of whole numbers, whatever library they come from.\"\"\"
    column, row = point
    return (operator.index(column), operator.index(row))
",
    },
    Helper {
        name: "mirror",
        calls: &[],
        rust: "\
/// The point on the other side of another.
fn mirror(of: [f64; 2], about: [f64; 2]) -> [f64; 2] {
    [2.0 * about[0] - of[0], 2.0 * about[1] - of[1]]
}
",
        python: "\
def _mirror(of, about):
    \"\"\"The point on the other side of another.\"\"\"
    return (2.0 * about[0] - of[0], 2.0 * about[1] - of[1])
",
    },
    Helper {
        name: "carried",
        calls: &[],
        rust: "\
/// Where a direction and a length lead, pixels.
fn carried(from: [f64; 2], vector: [f64; 2], length_px: f64) -> [f64; 2] {
    [from[0] + vector[0] * length_px, from[1] + vector[1] * length_px]
}
",
        python: "\
def _carried(start, vector, length_px):
    \"\"\"Where a direction and a length lead, pixels.\"\"\"
    return (start[0] + vector[0] * length_px, start[1] + vector[1] * length_px)
",
    },
    Helper {
        name: "square",
        calls: &[],
        rust: "\
/// The square of a length.
fn square(length: f64) -> f64 {
    length * length
}
",
        python: "\
def _square(length):
    \"\"\"The square of a length.\"\"\"
    return length * length
",
    },
    Helper {
        name: "distance_squared",
        calls: &[],
        rust: "\
/// The square of the distance between two points.
fn distance_squared(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (du, dv) = (a[0] - b[0], a[1] - b[1]);
    du * du + dv * dv
}
",
        python: "\
def _distance_squared(a, b):
    \"\"\"The square of the distance between two points.\"\"\"
    du, dv = a[0] - b[0], a[1] - b[1]
    return du * du + dv * dv
",
    },
    Helper {
        name: "chebyshev_squared",
        calls: &[],
        rust: "\
/// The square of the larger of the distances between two points along the axes.
fn chebyshev_squared(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (du, dv) = (a[0] - b[0], a[1] - b[1]);
    let (du, dv) = (du * du, dv * dv);
    if du > dv { du } else { dv }
}
",
        python: "\
def _chebyshev_squared(a, b):
    \"\"\"The square of the larger of the distances between two points along the axes.\"\"\"
    du, dv = a[0] - b[0], a[1] - b[1]
    du, dv = du * du, dv * dv
    return du if du > dv else dv
",
    },
    coordinate_squared!("x", "left", "0"),
    coordinate_squared!("y", "top", "1"),
    Helper {
        name: "signed_square",
        calls: &[],
        rust: "\
/// The square of a number, with its sign.
fn signed_square(value: f64) -> f64 {
    if value < 0.0 { -(value * value) } else { value * value }
}
",
        python: "\
def _signed_square(value):
    \"\"\"The square of a number, with its sign.\"\"\"
    return -(value * value) if value < 0.0 else value * value
",
    },
    Helper {
        name: "from_to",
        calls: &[],
        rust: "\
/// The direction from one point to another, not of length 1.
fn from_to(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    [to[0] - from[0], to[1] - from[1]]
}
",
        python: "\
def _from_to(start, end):
    \"\"\"The direction from one point to another, not of length 1.\"\"\"
    return (end[0] - start[0], end[1] - start[1])
",
    },
    angle!("less", "less than", ">"),
    angle!("at_most", "at most", ">="),
    angle!("greater", "greater than", "<"),
    angle!("at_least", "at least", "<="),
    Helper {
        name: "angle_sides",
        calls: &["signed_square"],
        rust: "\
/// The cosine of an angle and of its limit, squared with their signs, times both squared lengths.
///
/// The larger an angle, the smaller its cosine. This needs no root and no trigonometry. Sides that differ only by
/// rounding are equal.
fn angle_sides(a: [f64; 2], b: [f64; 2], limit_cos: f64) -> (f64, f64) {
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let along = signed_square(dot(a, b));
    let size = dot(a, a) * dot(b, b);
    let limit = signed_square(limit_cos) * size;
    if (along - limit).abs() <= 1e-12 * size {
        (limit, limit)
    } else {
        (along, limit)
    }
}
",
        python: "\
def _angle_sides(a, b, limit_cos):
    \"\"\"The cosine of an angle and of its limit, squared with their signs, times both squared lengths.

    The larger an angle, the smaller its cosine. This needs no root and no trigonometry. Sides that differ only by
    rounding are equal.
    \"\"\"
    along = _signed_square(_dot(a, b))
    size = _dot(a, a) * _dot(b, b)
    limit = _signed_square(limit_cos) * size
    return (limit if abs(along - limit) <= 1e-12 * size else along), limit


def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1]
",
    },
    Helper {
        name: "count",
        calls: &["points"],
        rust: "\
/// How many points a keypoint has.
fn count(facts: &Facts<'_>, name: &'static str) -> Result<f64, Refusal> {
    match facts.scene.points(name) {
        Some(points) => Ok(points.len() as f64),
        None => Err(Refusal::Missing(name)),
    }
}
",
        python: "\
def _count(facts, name):
    \"\"\"How many points a keypoint has.\"\"\"
    points = _points(facts, name)
    if points is None:
        raise Missing(name)
    return float(len(points))
",
    },
    Helper {
        name: "area_px",
        calls: &[],
        rust: "\
/// How many pixels a mask has.
fn area_px(facts: &Facts<'_>, name: &'static str) -> Result<f64, Refusal> {
    facts.scene.area_px(name).ok_or(Refusal::Missing(name))
}
",
        python: "\
def _area_px(facts, name):
    \"\"\"How many pixels a mask has.\"\"\"
    area = facts.scene.area_px(name)
    if area is None:
        raise Missing(name)
    return float(area)
",
    },
    Helper {
        name: "distance_px",
        calls: &["whole"],
        rust: "\
/// How far the nearest pixel of a point is from a mask or box; infinitely far from an empty one.
fn distance_px(facts: &Facts<'_>, point: [f64; 2], region: &'static str) -> f64 {
    let pixel = [whole(point[0]), whole(point[1])];
    facts.scene.distance_px(region, pixel).unwrap_or(f64::INFINITY)
}
",
        python: "\
def _distance_px(facts, point, region):
    \"\"\"How far the nearest pixel of a point is from a mask or box; infinitely far from an empty one.\"\"\"
    distance = facts.scene.distance_px(region, (_whole(point[0]), _whole(point[1])))
    return math.inf if distance is None else float(distance)
",
    },
    Helper {
        name: "whole",
        calls: &[],
        rust: "\
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
        python: "\
def _whole(value):
    \"\"\"The nearest whole number, within 32 bits; halves go up.\"\"\"
    raised = value + 0.5
    if raised != raised:
        return 0
    return math.floor(max(-2147483648.0, min(2147483647.0, raised)))
",
    },
];

/// Returns the name of the helper that computes the square of a measure of points; fails for an unknown measure.
pub(super) fn of_measure(measure: &str) -> Result<&'static str, EmitError> {
    let wanted = |name: &str| name.strip_suffix("_squared") == Some(measure);
    let helper = HELPERS.iter().find(|helper| wanted(helper.name));
    helper
        .map(|helper| helper.name)
        .ok_or_else(|| EmitError::Reference {
            name: measure.to_owned(),
            wanted: "a measure with helper functions",
        })
}

/// Adds the helpers that these call, directly or through others.
pub(super) fn with_dependencies(mut names: BTreeSet<&'static str>) -> BTreeSet<&'static str> {
    loop {
        let n_names = names.len();
        for helper in HELPERS {
            if names.contains(helper.name) {
                names.extend(helper.calls);
            }
        }
        if names.len() == n_names {
            return names;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fab_program::measures::{MEASURES, Make};

    #[test]
    fn every_length_of_points_has_a_helper() {
        for row in MEASURES {
            let name = row.signature.name;
            let is_length = matches!(row.make, Make::Length(_));
            assert_eq!(of_measure(name).is_ok(), is_length, "{name}");
        }
    }

    #[test]
    fn every_helper_that_another_calls_is_in_the_table() {
        for called in HELPERS.iter().flat_map(|helper| helper.calls) {
            assert!(HELPERS.iter().any(|it| it.name == *called), "{called}");
        }
    }
}
