//! The frame of a cloth's outline: its best-fitting rectangle.
//!
//! In: points of an outline, `[right, up]` (pixels of a picture with the row axis flipped, so that angles grow
//! counter-clockwise as seen). Out: a [`Frame`], which describes points by their fractions along and across the
//! rectangle. `super::instruction` puts these into words.

use super::instruction::CORNERS;
use fab_picture::hull::{Point, distance, distance_to_outline, dot, edges, minus, rectangle};

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
    /// Fits a frame to a convex outline; `None` if it has no area.
    ///
    /// `along` is the direction of the longer side, or else of the side closer to the picture's right; of its two
    /// orientations, the one that points right (or straight up).
    pub fn fit(hull: &[Point]) -> Option<Frame> {
        let fits = Frame::fits(hull, EQUAL_AREA);
        let (snuggest, _) = *fits.first()?;
        let frames = fits.into_iter().map(|(frame, _)| frame);
        let slimmest = first_greatest(frames, Frame::aspect)?;
        let is_clear = slimmest.aspect() > snuggest.aspect() * CLEARLY_SLIMMER;
        Some(if is_clear { slimmest } else { snuggest })
    }

    /// Returns all frames of a convex outline that exceed the tightest by less than a factor, the tightest first.
    ///
    /// Each has its relative excess area; empty if the outline has no area.
    pub fn fits(hull: &[Point], within: f64) -> Vec<(Frame, f64)> {
        let area = |frame: &Frame| frame.half[0] * frame.half[1];
        // The smallest rectangle around a hull has a side in the direction of one of the hull's.
        let flush = edges(hull).map(|(a, b)| {
            let along = minus(b, a).map(|step| step / distance(a, b));
            let (center, sides) = rectangle(hull, along);
            Frame {
                center,
                along,
                half: sides.map(|side| side / 2.0),
            }
        });
        let mut fits: Vec<Frame> = flush.filter(|frame| frame.short_side() > 0.0).collect();
        fits.sort_by(|a, b| area(a).total_cmp(&area(b)));
        let least = fits.first().map_or(0.0, area);
        fits.into_iter()
            .map(|frame| (frame.in_reading_order(), area(&frame) / least - 1.0))
            .filter(|&(_, excess)| excess < within - 1.0)
            .collect()
    }

    /// Returns the shorter side's length.
    pub fn short_side(&self) -> f64 {
        2.0 * self.half[0].min(self.half[1])
    }

    /// Returns the longer side's length.
    pub fn long_side(&self) -> f64 {
        2.0 * self.half[0].max(self.half[1])
    }

    fn aspect(&self) -> f64 {
        self.long_side() / self.short_side()
    }

    /// Returns whether the frame has long and short sides.
    pub fn has_long_sides(&self) -> bool {
        self.aspect() >= LONG
    }

    /// Returns whether no side is longer than those along.
    pub fn is_along_long_side(&self) -> bool {
        self.half[0] >= self.half[1]
    }

    /// Returns the angle of `along`, radians counter-clockwise from the picture's right.
    pub fn angle(&self) -> f64 {
        self.along[1].atan2(self.along[0])
    }

    /// Returns the same rectangle with its sides renamed by quarter turns, counter-clockwise.
    pub fn turned(&self, quarter_turns: u32) -> Frame {
        (0..quarter_turns % 4).fold(*self, |frame, _| Frame {
            along: quarter_turn(frame.along),
            half: [frame.half[1], frame.half[0]],
            ..frame
        })
    }

    /// Returns a point's fractions along and across, 0 to 1; outside that range beyond the rectangle.
    pub fn share_of(&self, point: Point) -> [f64; 2] {
        let off = minus(point, self.center);
        let axes = [self.along, quarter_turn(self.along)];
        [0, 1].map(|side| (dot(off, axes[side]) / self.half[side] + 1.0) / 2.0)
    }

    /// Returns the point at the given eighths along and across.
    pub fn point_at(&self, eighths: [u8; 2]) -> Point {
        let share = |side: usize| f64::from(eighths[side]) / 4.0 - 1.0;
        let [s, t] = [0, 1].map(|side| share(side) * self.half[side]);
        let across = quarter_turn(self.along);
        [0, 1].map(|axis| self.center[axis] + s * self.along[axis] + t * across[axis])
    }

    /// Returns the outline's distance from each of [`CORNERS`], relative to the short side.
    pub fn corner_gaps(&self, hull: &[Point]) -> [f64; 4] {
        CORNERS.map(|corner| distance_to_outline(hull, self.point_at(corner)) / self.short_side())
    }

    fn in_reading_order(self) -> Frame {
        let turns = (0..4).map(|turns| self.turned(turns));
        let turns = turns.filter(|frame| !self.has_long_sides() || frame.is_along_long_side());
        first_greatest(turns, |frame| frame.along[0] + frame.along[1] * 1e-6).unwrap_or(self)
    }
}

/// Returns the frame with the greatest value; of equal ones, the first.
fn first_greatest(frames: impl Iterator<Item = Frame>, of: fn(&Frame) -> f64) -> Option<Frame> {
    frames.reduce(|best, frame| if of(&frame) > of(&best) { frame } else { best })
}

fn quarter_turn([right, up]: Point) -> Point {
    [-up, right]
}
