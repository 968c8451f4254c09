//! Convex outlines of points in the plane.
//!
//! In: points. Out: their hull, and whether other points are in it and how far from it. The only assumption about the
//! two axes is that they are perpendicular.

/// A point or direction.
pub type Point = [f64; 2];

/// Returns the convex hull of points, counter-clockwise, without points on its edges.
///
/// Fewer than three points remain if the input has no area. The order of the input does not matter.
pub fn around(points: impl IntoIterator<Item = Point>) -> Vec<Point> {
    let mut sorted: Vec<Point> = points
        .into_iter()
        .filter(|point| point.iter().all(|value| value.is_finite()))
        .collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut outline = half_hull(sorted.iter().copied());
    outline.extend(half_hull(sorted.iter().rev().copied()));
    outline
}

/// Builds one side of the hull, without its last point, which starts the other side.
fn half_hull(sorted: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut chain: Vec<Point> = Vec::new();
    for point in sorted {
        while let [.., a, b] = chain[..] {
            if cross(minus(b, a), minus(point, a)) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain.pop();
    chain
}

/// Returns the distance from a point to the boundary of a hull, inside or outside; infinite for an empty hull.
pub fn distance_to_outline(hull: &[Point], point: Point) -> f64 {
    edges(hull)
        .map(|(a, b)| distance_to_segment(point, a, b))
        .fold(f64::INFINITY, f64::min)
}

/// Returns whether a point lies in a hull or on its boundary.
pub fn is_inside(hull: &[Point], point: Point) -> bool {
    hull.len() >= 3 && edges(hull).all(|(a, b)| cross(minus(b, a), minus(point, a)) >= 0.0)
}

/// Returns the distance between two points.
pub fn distance(a: Point, b: Point) -> f64 {
    let [right, up] = minus(a, b);
    right.hypot(up)
}

/// Returns the mean of points; not a number without any.
pub fn mean(points: impl Iterator<Item = Point>) -> Point {
    let (sum, n) = points.fold(([0.0, 0.0], 0), |(sum, n), at| {
        ([sum[0] + at[0], sum[1] + at[1]], n + 1)
    });
    sum.map(|total| total / f64::from(n))
}

/// Returns the sides of a hull, each from one point to the next.
pub fn edges(hull: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    hull.iter()
        .copied()
        .zip(hull.iter().copied().cycle().skip(1))
}

/// Returns the rectangle around points that has a side along a unit vector: its center, and its sides along the vector and
/// across it.
pub fn rectangle(points: &[Point], along: Point) -> (Point, [f64; 2]) {
    let across = [-along[1], along[0]];
    let extents = [along, across].map(|axis| {
        let places = || points.iter().map(|&point| dot(point, axis));
        let most = places().fold(f64::NEG_INFINITY, f64::max);
        [places().fold(f64::INFINITY, f64::min), most]
    });
    let [x, y] = extents.map(|[least, most]| (least + most) / 2.0);
    (
        [0, 1].map(|axis| x * along[axis] + y * across[axis]),
        extents.map(|[least, most]| most - least),
    )
}

fn distance_to_segment(point: Point, a: Point, b: Point) -> f64 {
    let (run, offset) = (minus(b, a), minus(point, a));
    // Two equal ends are a point, where the share does not matter.
    let share = dot(offset, run) / dot(run, run).max(f64::MIN_POSITIVE);
    let share = share.clamp(0.0, 1.0);
    distance(offset, [run[0] * share, run[1] * share])
}

/// Returns the vector from `b` to `a`.
pub fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// Returns the dot product.
pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
