# The functions that emitted checks call, the same as in `support.rs`; without these lines, the end of each module.
#
# Each does what one line of `fab_program::eval` does, on the same floats in the same order. Whole numbers become
# floats first, because those of Python never round.


def is_point(scene, keypoints, point):
    """Whether a pixel is one of the points of these keypoints."""
    wanted = pixel(point)
    return any(
        wanted == pixel(offered)
        for keypoint in keypoints
        for offered in (points_of(scene, keypoint) or ())
    )


def is_inside(scene, masks, point):
    """Whether a pixel lies in one of these masks."""
    distances = [scene.distance_px(mask, pixel(point)) for mask in masks]
    return any(distance is not None and distance <= 0.0 for distance in distances)


def is_word(choices, word):
    """Whether a word is one of the choices."""
    return any(choice == word for choice in choices)


def is_choice(choices, value):
    """Whether a number is one of the choices."""
    return any(choice == value for choice, _ in choices)


def chosen(choices, value, field):
    """What a chosen number stands for: metres, or a vector, right and down."""
    for choice, meaning in choices:
        if choice == value:
            return meaning
    raise Missing(field)


def known(last):
    """The action before this one."""
    if last is None:
        raise Missing("last")
    return last


def keypoint(scene, name):
    """The point of a keypoint."""
    points = points_of(scene, name)
    if not points:
        raise Missing(name)
    return at(points[0])


def points_of(scene, name):
    """The points of a keypoint as a list; None where there is none of that name."""
    points = scene.points(name)
    return None if points is None else list(points)


def at(point):
    """A pixel as floats."""
    column, row = pixel(point)
    return (float(column), float(row))


def pixel(point):
    """A pixel as a pair of whole numbers, whatever library they come from."""
    column, row = point
    return (operator.index(column), operator.index(row))


def mirror(of, about):
    """The point on the other side of another."""
    return (2.0 * about[0] - of[0], 2.0 * about[1] - of[1])


def carried(start, vector, length_px):
    """Where a direction and a length lead, pixels."""
    return (start[0] + vector[0] * length_px, start[1] + vector[1] * length_px)


def square(length):
    """The square of a length."""
    return length * length


def signed_square(value):
    """The square of a number, with its sign."""
    return -(value * value) if value < 0.0 else value * value


def larger(one, other):
    """The larger of two numbers."""
    return one if one > other else other


def from_to(start, end):
    """The direction from one point to another, not of length 1."""
    return (end[0] - start[0], end[1] - start[1])


def angle_less(a, b, limit_cos):
    """Whether an angle is less than the one with this cosine."""
    along, limit = angle_sides(a, b, limit_cos)
    return along > limit


def angle_at_most(a, b, limit_cos):
    """Whether an angle is at most the one with this cosine."""
    along, limit = angle_sides(a, b, limit_cos)
    return along >= limit


def angle_greater(a, b, limit_cos):
    """Whether an angle is greater than the one with this cosine."""
    along, limit = angle_sides(a, b, limit_cos)
    return along < limit


def angle_at_least(a, b, limit_cos):
    """Whether an angle is at least the one with this cosine."""
    along, limit = angle_sides(a, b, limit_cos)
    return along <= limit


def angle_sides(a, b, limit_cos):
    """The cosine of an angle and of its limit, squared with their signs, times both squared lengths.

    The larger an angle, the smaller its cosine. This needs no root and no trigonometry. Sides that differ only by
    rounding are equal.
    """
    along = signed_square(dot(a, b))
    size = dot(a, a) * dot(b, b)
    limit = signed_square(limit_cos) * size
    return (limit if abs(along - limit) <= 1e-12 * size else along), limit


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def count(scene, name):
    """How many points a keypoint has."""
    points = points_of(scene, name)
    if points is None:
        raise Missing(name)
    return float(len(points))


def area_px(scene, name):
    """How many pixels a mask has."""
    area = scene.area_px(name)
    if area is None:
        raise Missing(name)
    return float(area)


def distance_px(scene, point, region):
    """How far the nearest pixel of a point is from a mask or box; infinitely far from an empty one."""
    distance = scene.distance_px(region, (whole(point[0]), whole(point[1])))
    return math.inf if distance is None else float(distance)


def whole(value):
    """The nearest whole number, within 32 bits; halves go up."""
    raised = value + 0.5
    if raised != raised:
        return 0
    return math.floor(max(-2147483648.0, min(2147483647.0, raised)))
