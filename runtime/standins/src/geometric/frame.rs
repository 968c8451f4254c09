//! The frame of a cloth's outline: its best-fitting rectangle.
//!
//! In: points of an outline, `[right, up]` (pixels of a picture with the row axis flipped, so that angles grow
//! counter-clockwise as seen). Out: a [`Frame`], which describes points by their fractions along and across the
//! rectangle. `super::words` puts these into words.

use fab_picture::hull::{Point, distance, distance_to_outline, dot, edges, minus};

/// A rectangle around an outline, with an order of its sides.
///
/// `along` is the direction of its long side, if it has one; `across` is `along` turned a quarter counter-clockwise. A
/// cloth is never mirrored, so neither is its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    center: Point,
    /// Unit vector.
    along: Point,
    /// Half the side along, then half the side across.
    half: [f64; 2],
}

/// Rectangles whose areas differ by less than this factor count as equally tight.
const EQUAL_AREA: f64 = 1.08;

/// Of equally tight rectangles, a slimmer one wins if it is slimmer by this factor: the rectangle on the long side of a
/// right-angled triangle and the square on its short sides are equally tight.
const CLEARLY_SLIMMER: f64 = 1.3;

/// From this ratio of sides on, a rectangle has long and short sides.
const LONG: f64 = 1.08;

impl Frame {
    /// Fits a frame to a convex outline as returned by [`hull`]; `None` if it has no area.
    ///
    /// `along` is the direction of the longer side, or else of the side closer to the picture's right; of its two
    /// orientations, the one that points right (or straight up).
    pub fn fit(hull: &[Point]) -> Option<Frame> {
        let fits = Frame::fits(hull, EQUAL_AREA);
        let (snuggest, _) = *fits.first()?;
        let slimmest = fits
            .into_iter()
            .map(|(frame, _)| frame)
            .reduce(|best, frame| {
                if frame.aspect() > best.aspect() {
                    frame
                } else {
                    best
                }
            })
            .filter(|frame| frame.aspect() > snuggest.aspect() * CLEARLY_SLIMMER);
        Some(slimmest.unwrap_or(snuggest))
    }

    /// Returns all frames of a convex outline that exceed the tightest by less than a factor, the tightest first.
    ///
    /// Each has its relative excess area; empty if the outline has no area.
    pub fn fits(hull: &[Point], within: f64) -> Vec<(Frame, f64)> {
        let mut fits: Vec<Frame> = edges(hull)
            .filter_map(|(a, b)| flush_with(hull, a, b))
            .filter(|frame| frame.half[0].min(frame.half[1]) > 0.0)
            .collect();
        fits.sort_by(|a, b| a.area().total_cmp(&b.area()));
        let Some(least) = fits.first().map(Frame::area) else {
            return Vec::new();
        };
        fits.into_iter()
            .map(|frame| (frame.in_reading_order(), frame.area() / least - 1.0))
            .filter(|&(_, excess)| excess < within - 1.0)
            .collect()
    }

    /// Returns whether the frame has long and short sides.
    pub fn has_long_sides(&self) -> bool {
        self.aspect() >= LONG
    }

    /// Returns the shorter side's length.
    pub fn short_side(&self) -> f64 {
        2.0 * self.half[0].min(self.half[1])
    }

    /// Returns the longer side's length.
    pub fn long_side(&self) -> f64 {
        2.0 * self.half[0].max(self.half[1])
    }

    /// Returns the angle of `along`, radians counter-clockwise from the picture's right.
    pub fn angle(&self) -> f64 {
        self.along[1].atan2(self.along[0])
    }

    /// Returns the same rectangle with its sides renamed by quarter turns, counter-clockwise.
    pub fn turned(&self, quarter_turns: u32) -> Frame {
        (0..quarter_turns % 4).fold(*self, |frame, _| Frame {
            center: frame.center,
            along: quarter_turn(frame.along),
            half: [frame.half[1], frame.half[0]],
        })
    }

    /// Returns the frame, turned once if its sides across are the longer ones.
    pub fn with_long_side_first(&self) -> Frame {
        self.turned(u32::from(self.half[0] < self.half[1]))
    }

    /// Returns a point's fractions along and across, 0 to 1; outside that range beyond the rectangle.
    pub fn share_of(&self, point: Point) -> [f64; 2] {
        let from_center = minus(point, self.center);
        let along = dot(from_center, self.along) / self.half[0];
        let across = dot(from_center, quarter_turn(self.along)) / self.half[1];
        [(along + 1.0) / 2.0, (across + 1.0) / 2.0]
    }

    /// Returns the point at the given fractions along and across.
    pub fn point_at(&self, [along, across]: [f64; 2]) -> Point {
        let across_axis = quarter_turn(self.along);
        let (s, t) = (
            (2.0 * along - 1.0) * self.half[0],
            (2.0 * across - 1.0) * self.half[1],
        );
        [
            self.center[0] + s * self.along[0] + t * across_axis[0],
            self.center[1] + s * self.along[1] + t * across_axis[1],
        ]
    }

    /// Returns the outline's distance from each corner of the rectangle, relative to the short side.
    ///
    /// Corners go counter-clockwise from the start of `along`: (0, 0), (1, 0), (1, 1), (0, 1).
    pub fn corner_gaps(&self, hull: &[Point]) -> [f64; 4] {
        CORNERS.map(|corner| distance_to_outline(hull, self.point_at(corner)) / self.short_side())
    }

    fn area(&self) -> f64 {
        self.half[0] * self.half[1]
    }

    fn aspect(&self) -> f64 {
        let (short, long) = (
            self.half[0].min(self.half[1]),
            self.half[0].max(self.half[1]),
        );
        if short > 0.0 {
            long / short
        } else {
            f64::INFINITY
        }
    }

    fn in_reading_order(self) -> Frame {
        let turns = (0..4).map(|turns| self.turned(turns));
        let rightness = |frame: &Frame| frame.along[0] + frame.along[1] * 1e-6;
        let candidates =
            turns.filter(|frame| !self.has_long_sides() || frame.half[0] > frame.half[1]);
        candidates
            .reduce(|best, frame| {
                if rightness(&frame) > rightness(&best) {
                    frame
                } else {
                    best
                }
            })
            .unwrap_or(self)
    }
}

/// The corners of a frame as fractions along and across, counter-clockwise.
pub const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// The smallest rectangle around a hull that has a side along the edge from `a` to `b`.
fn flush_with(hull: &[Point], a: Point, b: Point) -> Option<Frame> {
    let length = distance(a, b);
    if length <= 0.0 {
        return None;
    }
    let along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    let across = quarter_turn(along);
    let extent = |axis: Point| {
        let span = (f64::INFINITY, f64::NEG_INFINITY);
        hull.iter()
            .map(|&point| dot(point, axis))
            .fold(span, |(least, most), value| {
                (value.min(least), value.max(most))
            })
    };
    let ((left, right), (low, high)) = (extent(along), extent(across));
    let (s, t) = ((left + right) / 2.0, (low + high) / 2.0);
    Some(Frame {
        center: [s * along[0] + t * across[0], s * along[1] + t * across[1]],
        along,
        half: [(right - left) / 2.0, (high - low) / 2.0],
    })
}

fn quarter_turn([right, up]: Point) -> Point {
    [-up, right]
}
