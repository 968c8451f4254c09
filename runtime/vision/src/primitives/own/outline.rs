//! Outlines: a piece of a mask followed along its border, and polygons with fewer vertices.
//!
//! In: pixels. Out: closed polygons of pixels. Borders are followed as in Suzuki and Abe (1985), polygons simplified
//! as in Douglas and Peucker (1973). Which of several equally good vertices is kept decides what a prompt lists, so both
//! choose as OpenCV's `findContours` and `approxPolyDP` do.

use crate::VisionError;
use fab_picture::Mask;
use fab_program::PixelPoint;

/// Steps to the eight neighbours, counter-clockwise to the eye from the right one.
const STEPS: [(i32, i32); 8] = [
    (1, 0),
    (1, -1),
    (0, -1),
    (-1, -1),
    (-1, 0),
    (-1, 1),
    (0, 1),
    (1, 1),
];

/// Returns the outer border of a mask's only piece, counter-clockwise from its upper left pixel; empty if the mask is.
///
/// Pixels that touch at a corner are connected. A part one pixel wide is passed on the way there and on the way back.
pub fn outer_outline(piece: &Mask) -> Result<Vec<PixelPoint>, VisionError> {
    let Some(start) = piece.pixels().next() else {
        return Ok(Vec::new());
    };
    let neighbour = |pixel: PixelPoint, step: usize| {
        let (right, down) = STEPS[step % 8];
        PixelPoint::new(pixel.u + right, pixel.v + down)
    };
    // Nothing lies above or left of the first pixel of a row by row search, so its last neighbour clockwise from the
    // left one closes the border.
    let Some(closing) = (0..8)
        .map(|turn| 11 - turn)
        .find(|&step| piece.contains(neighbour(start, step)))
    else {
        return Ok(vec![start]);
    };
    let before = neighbour(start, closing);
    let (mut at, mut back) = (start, closing);
    let mut border = Vec::new();
    loop {
        let step = (back + 1..back + 9)
            .find(|&step| piece.contains(neighbour(at, step)))
            .unwrap_or(back);
        border.push(at);
        let next = neighbour(at, step);
        if next == start && at == before {
            return Ok(border);
        }
        (at, back) = (next, (step + 4) % 8);
    }
}

/// Returns a closed polygon that keeps some of an outline's vertices, and stays within about `tolerance_px` of it.
pub fn simplified(
    outline: &[PixelPoint],
    tolerance_px: f64,
) -> Result<Vec<PixelPoint>, VisionError> {
    if outline.is_empty() {
        return Ok(Vec::new());
    }
    let [one, other] = far_apart(outline);
    if squared_px(outline[one], outline[other]) as f64 <= tolerance_px * tolerance_px {
        return Ok(vec![outline[one]]);
    }
    let mut polygon = Vec::new();
    // Parts that may need a split, the next one last. A stack, because there may be as many splits as vertices.
    let mut parts = vec![(other, one), (one, other)];
    while let Some((first, last)) = parts.pop() {
        match farthest(outline, first, last, tolerance_px) {
            Some(middle) => parts.extend([(middle, last), (first, middle)]),
            None => polygon.push(outline[first]),
        }
    }
    Ok(straightened(&polygon, tolerance_px))
}

/// Returns two vertices that are far apart.
fn far_apart(outline: &[PixelPoint]) -> [usize; 2] {
    let mut pair = [0, 0];
    // The farthest vertex from the farthest vertex; once more is enough.
    for _ in 0..3 {
        let from = pair[1];
        pair = [from, from];
        for to in behind(outline, from, from) {
            if squared_px(outline[from], outline[to]) > squared_px(outline[from], outline[pair[1]])
            {
                pair[1] = to;
            }
        }
    }
    pair
}

/// Returns the vertex between two others that is farthest from their line; `None` if all are within the tolerance.
fn farthest(outline: &[PixelPoint], first: usize, last: usize, tolerance_px: f64) -> Option<usize> {
    let (from, to) = (outline[first], outline[last]);
    let (mut found, mut most) = (first, 0);
    for at in behind(outline, first, last) {
        let doubled_area = cross(from, to, outline[at]).abs();
        if doubled_area > most {
            (found, most) = (at, doubled_area);
        }
    }
    let limit = tolerance_px * tolerance_px * squared_px(from, to) as f64;
    ((most as f64) * (most as f64) > limit).then_some(found)
}

/// Returns the vertices behind one up to another, both excluded; the whole round if they are the same.
fn behind(outline: &[PixelPoint], first: usize, last: usize) -> impl Iterator<Item = usize> {
    let n_all = outline.len();
    let until = if last > first { last } else { last + n_all };
    (first + 1..until).map(move |at| at % n_all)
}

/// Leaves out vertices on nearly straight sides; the next one then stays. Upright and level sides keep theirs.
fn straightened(polygon: &[PixelPoint], tolerance_px: f64) -> Vec<PixelPoint> {
    let n_all = polygon.len();
    let mut kept: Vec<PixelPoint> = Vec::new();
    let mut n_kept = n_all;
    let mut before = polygon[n_all - 1];
    let mut at = 0;
    while at < n_all {
        let vertex = polygon[at];
        // Behind the last vertex comes the first one that was kept.
        let next = polygon
            .get(at + 1)
            .or(kept.first())
            .copied()
            .unwrap_or(vertex);
        if n_kept > 2 && is_straight(before, vertex, next, tolerance_px) {
            n_kept -= 1;
            kept.push(next);
            at += 2;
        } else {
            kept.push(vertex);
            at += 1;
        }
        before = kept[kept.len() - 1];
    }
    // The first one was kept twice if the last one was left out.
    kept.truncate(n_kept);
    kept
}

/// Returns whether a slanted side between two vertices passes a third one on its way.
fn is_straight(from: PixelPoint, vertex: PixelPoint, to: PixelPoint, tolerance_px: f64) -> bool {
    let doubled_area = cross(from, to, vertex) as f64;
    let limit = 0.5 * tolerance_px * tolerance_px * squared_px(from, to) as f64;
    let [[x, y], [further_x, further_y]] = [minus(vertex, from), minus(to, vertex)];
    doubled_area * doubled_area <= limit
        && from.u != to.u
        && from.v != to.v
        && x * further_x + y * further_y >= 0
}

fn minus(a: PixelPoint, b: PixelPoint) -> [i64; 2] {
    [
        i64::from(a.u) - i64::from(b.u),
        i64::from(a.v) - i64::from(b.v),
    ]
}

fn squared_px(a: PixelPoint, b: PixelPoint) -> i64 {
    let [x, y] = minus(a, b);
    x * x + y * y
}

/// Returns twice the area of a triangle, with its sign.
fn cross(a: PixelPoint, b: PixelPoint, c: PixelPoint) -> i64 {
    let [[bx, by], [cx, cy]] = [minus(b, a), minus(c, a)];
    bx * cy - by * cx
}
