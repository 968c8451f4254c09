//! The small functions that emitted Python checks are made of.
//!
//! Each does what one line of [`fab_program::eval`] does, on the same floats in the same order. Whole numbers
//! become floats first, since Python's own never round.

/// By name; [`super::rust_helpers`] has the same ones but `all` and `any`, which Python has.
pub(super) const HELPERS: &[(&str, &str)] = &[
    (
        "is_point",
        "\
def _is_point(facts, keypoints, point):
    \"\"\"Whether a pixel is one of the points of these keypoints.\"\"\"
    wanted = _pixel(point)
    return any(
        wanted == _pixel(offered)
        for keypoint in keypoints
        for offered in (_points(facts, keypoint) or ())
    )
",
    ),
    (
        "is_inside",
        "\
def _is_inside(facts, masks, point):
    \"\"\"Whether a pixel lies in one of these masks.\"\"\"
    distances = [facts.scene.distance_px(mask, _pixel(point)) for mask in masks]
    return any(distance is not None and distance <= 0.0 for distance in distances)
",
    ),
    (
        "is_word",
        "\
def _is_word(choices, word):
    \"\"\"Whether a word is one of the choices.\"\"\"
    return any(choice == word for choice in choices)
",
    ),
    (
        "is_choice",
        "\
def _is_choice(choices, value):
    \"\"\"Whether a number is one of the choices.\"\"\"
    return any(choice == value for choice, _ in choices)
",
    ),
    (
        "chosen",
        "\
def _chosen(choices, value, field):
    \"\"\"What a chosen number stands for.\"\"\"
    for choice, meaning in choices:
        if choice == value:
            return meaning
    raise Missing(field)
",
    ),
    (
        "last",
        "\
def _last(facts):
    \"\"\"The action before this one.\"\"\"
    if facts.last is None:
        raise Missing(\"last\")
    return facts.last
",
    ),
    (
        "keypoint",
        "\
def _keypoint(facts, name):
    \"\"\"The point of a keypoint.\"\"\"
    points = _points(facts, name)
    if not points:
        raise Missing(name)
    return _at(points[0])
",
    ),
    (
        "points",
        "\
def _points(facts, name):
    \"\"\"The points of a keypoint as a list; None where there is none of that name.\"\"\"
    points = facts.scene.points(name)
    return None if points is None else list(points)
",
    ),
    (
        "at",
        "\
def _at(point):
    \"\"\"A pixel as floats; whole numbers of Python never round, and floats must.\"\"\"
    column, row = _pixel(point)
    return (float(column), float(row))
",
    ),
    (
        "pixel",
        "\
def _pixel(point):
    \"\"\"A pixel as a pair of whole numbers, whatever library they come from.\"\"\"
    column, row = point
    return (operator.index(column), operator.index(row))
",
    ),
    (
        "mirror",
        "\
def _mirror(of, about):
    \"\"\"The point on the other side of another.\"\"\"
    return (2.0 * about[0] - of[0], 2.0 * about[1] - of[1])
",
    ),
    (
        "carried",
        "\
def _carried(start, vector, length_px):
    \"\"\"Where a direction and a length lead, pixels.\"\"\"
    return (start[0] + vector[0] * length_px, start[1] + vector[1] * length_px)
",
    ),
    (
        "square",
        "\
def _square(length):
    \"\"\"The square of a length.\"\"\"
    return length * length
",
    ),
    (
        "distance_squared",
        "\
def _distance_squared(a, b):
    \"\"\"The square of the distance between two points.\"\"\"
    du, dv = a[0] - b[0], a[1] - b[1]
    return du * du + dv * dv
",
    ),
    (
        "chebyshev_squared",
        "\
def _chebyshev_squared(a, b):
    \"\"\"The square of the larger of the distances between two points along the axes.\"\"\"
    du, dv = a[0] - b[0], a[1] - b[1]
    du, dv = du * du, dv * dv
    return du if du > dv else dv
",
    ),
    (
        "from_to",
        "\
def _from_to(start, end):
    \"\"\"The direction from one point to another, not of length 1.\"\"\"
    return (end[0] - start[0], end[1] - start[1])
",
    ),
    (
        "angle_less",
        "\
def _angle_less(a, b, limit_cos):
    \"\"\"Whether an angle is less than the one with this cosine.\"\"\"
    along, limit = _angle_sides(a, b, limit_cos)
    return along > limit
",
    ),
    (
        "angle_at_most",
        "\
def _angle_at_most(a, b, limit_cos):
    \"\"\"Whether an angle is at most the one with this cosine.\"\"\"
    along, limit = _angle_sides(a, b, limit_cos)
    return along >= limit
",
    ),
    (
        "angle_greater",
        "\
def _angle_greater(a, b, limit_cos):
    \"\"\"Whether an angle is greater than the one with this cosine.\"\"\"
    along, limit = _angle_sides(a, b, limit_cos)
    return along < limit
",
    ),
    (
        "angle_at_least",
        "\
def _angle_at_least(a, b, limit_cos):
    \"\"\"Whether an angle is at least the one with this cosine.\"\"\"
    along, limit = _angle_sides(a, b, limit_cos)
    return along <= limit
",
    ),
    (
        "angle_sides",
        "\
def _angle_sides(a, b, limit_cos):
    \"\"\"The cosine of an angle and of its limit, squared with their signs, times both squared lengths.

    The larger an angle, the smaller its cosine. This needs no root and no trigonometry.
    \"\"\"
    along = _signed_square(_dot(a, b))
    return along, _signed_square(limit_cos) * (_dot(a, a) * _dot(b, b))


def _signed_square(value):
    return -(value * value) if value < 0.0 else value * value


def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1]
",
    ),
    (
        "count",
        "\
def _count(facts, name):
    \"\"\"How many points a keypoint has.\"\"\"
    points = _points(facts, name)
    if points is None:
        raise Missing(name)
    return float(len(points))
",
    ),
    (
        "area_px",
        "\
def _area_px(facts, name):
    \"\"\"How many pixels a mask has.\"\"\"
    area = facts.scene.area_px(name)
    if area is None:
        raise Missing(name)
    return float(area)
",
    ),
    (
        "distance_px",
        "\
def _distance_px(facts, point, region):
    \"\"\"How far the nearest pixel of a point is from a mask or box; infinitely far from an empty one.\"\"\"
    distance = facts.scene.distance_px(region, (_whole(point[0]), _whole(point[1])))
    return math.inf if distance is None else float(distance)
",
    ),
    (
        "whole",
        "\
def _whole(value):
    \"\"\"The nearest whole number, within 32 bits; halves go up.\"\"\"
    raised = value + 0.5
    if raised != raised:
        return 0
    return math.floor(max(-2147483648.0, min(2147483647.0, raised)))
",
    ),
];
