//! The black arrow of a subgoal picture.
//!
//! In: a picture. Out: the arrow's tail and tip, or why there is not exactly one. An arrow is a straight
//! stroke with a ring at one end; the cloth's position does not matter here.

use crate::Mask;
use crate::camera::center_of;
use crate::hull::{self, Point};
use crate::regions::{self, Patch};
use image::RgbImage;

/// An arrow; points are `[column, row]`, pixels, with pixel centres at halves.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrow {
    /// Centre of the ring.
    pub tail: Point,
    /// Point of the head.
    pub tip: Point,
    /// All of its pixels, and those inside of its ring, which are too few to tell cloth from table.
    pub stroke: Mask,
}

/// The brightest pixel that can belong to an arrow, 8-bit levels. Creases of the recorded cloths stay above 90.
const BLACK: u8 = 48;

/// Radius of the ring and width of all strokes, pixels of a 224 px picture, as the paper drew them; the strokes of
/// `fab_vision` are a little narrower.
const RING_RADIUS_PX: f64 = 3.0;
const STROKE_PX: f64 = 2.0;

/// The shortest arrow, from the ring's centre to the tip, pixels of a 224 px picture; shorter ones are nothing but ring
/// and head.
const SHORTEST_PX: f64 = 8.0;

/// Least share of the line from ring to tip that must be black.
const LEAST_LINE: f64 = 0.9;

/// The most black patches, and holes in one patch, that are examined; bounds the work on a noise picture.
const MAX_PIECES: usize = 64;

/// Collects the pixels dark enough to belong to an arrow.
fn near_black(picture: &RgbImage) -> Mask {
    Mask::from_fn(picture.width(), picture.height(), |column, row| {
        let rgb = picture.get_pixel(column, row).0;
        rgb.iter().all(|&level| level <= BLACK)
    })
}

/// Finds the only arrow of a picture; fails with how many there are, in words.
///
/// `scale` is the stroke size relative to a 224 px picture, at least 1.
pub fn find(picture: &RgbImage, scale: f64) -> Result<Arrow, &'static str> {
    let (pen, ink) = (Pen::at(scale), &near_black(picture));
    let mut patches = regions::components(ink);
    patches.retain(|patch| patch.len() as f64 >= SHORTEST_PX * scale);
    patches.sort_by_key(|patch| std::cmp::Reverse(patch.len()));
    let mut rings = Vec::new();
    for patch in patches.iter().take(MAX_PIECES) {
        let tails = pen.rings(ink, patch).into_iter();
        rings.extend(tails.map(|(tail, _)| (patch, tail)));
    }
    let arrow = |&(patch, tail)| Some((patch, tail, pen.tip(tail, patch, ink)?));
    let (patch, tail, tip) = rings.iter().find_map(arrow).ok_or("no arrow")?;
    // When two arrows cross, perhaps only one leads straight to the farthest pixel, but both have rings.
    if rings.len() > 1 {
        return Err("more than one arrow");
    }
    let inked = Mask::from_pixels(ink.width(), ink.height(), patch);
    let stroke = Mask::from_fn(ink.width(), ink.height(), |column, row| {
        inked.contains_at(column, row)
            || hull::distance([column, row].map(|at| f64::from(at) + 0.5), tail) <= pen.ring_radius
    });
    Ok(Arrow { tail, tip, stroke })
}

/// Sizes of an arrow's parts in a picture, pixels.
struct Pen {
    scale: f64,
    ring_radius: f64,
    /// Just outside the ring.
    clear_radius: f64,
}

/// The center of a ring, and in how many of [`N_DIRECTIONS`] it is closed.
type Ring = (Point, i32);

/// Directions in which a ring is probed.
const N_DIRECTIONS: u32 = 24;

/// Least number of directions with ink on the ring's radius minus those with ink just outside it. A ring has about 19;
/// the line takes the others. A head whose strokes are long enough to enclose a pixel has ink outside as well.
const LEAST_RINGED: i32 = 15;

impl Pen {
    fn at(scale: f64) -> Pen {
        let ring_radius = (RING_RADIUS_PX * scale).round();
        let half_width = (STROKE_PX * scale).floor() / 2.0;
        Pen {
            scale,
            ring_radius,
            clear_radius: ring_radius + half_width + 1.2 * scale,
        }
    }

    /// Returns the rings in a patch.
    fn rings(&self, ink: &Mask, patch: &Patch) -> Vec<Ring> {
        let most_px = std::f64::consts::PI * self.ring_radius.powi(2);
        let is_near = |a: Point, b: Point| hull::distance(a, b) <= 3.0 * self.ring_radius;
        let mut holes = regions::holes(patch);
        holes.retain(|hole| (hole.len() as f64) < most_px);
        let mut rings: Vec<Ring> = Vec::new();
        for hole in holes.iter().take(MAX_PIECES) {
            let hole = hull::mean(hole.iter().copied().map(center_of));
            // The line cuts the inside of its own ring into several holes.
            if !rings.iter().any(|ring| is_near(ring.0, hole)) {
                rings.extend(self.ring_around(hole, ink));
            }
        }
        // A long arrow's head can pass for a ring where its strokes meet, but it is open on one side.
        let is_head = |ring: &Ring| {
            let mut clearer = rings.iter().filter(|other| other.1 > ring.1);
            clearer.any(|other| {
                let tip = self.tip(other.0, patch, ink);
                tip.is_some_and(|tip| is_near(tip, ring.0))
            })
        };
        rings
            .iter()
            .copied()
            .filter(|ring| !is_head(ring))
            .collect()
    }

    /// Finds the middle of the ring that a hole is part of; `None` if no ring is near.
    fn ring_around(&self, hole: Point, ink: &Mask) -> Option<Ring> {
        const STEPS: i32 = 12;
        let step_px = 0.5 * self.scale;
        // The ring's stroke is wide enough to fit equally well in several places; take their middle.
        let (mut most, mut equals) = (LEAST_RINGED, Vec::new());
        for (down, right) in (-STEPS..=STEPS).flat_map(|d| (-STEPS..=STEPS).map(move |r| (d, r))) {
            let off = [right, down].map(|steps| f64::from(steps) * step_px);
            let center = [hole[0] + off[0], hole[1] + off[1]];
            let ringed = inked_directions(ink, center, self.ring_radius)
                - inked_directions(ink, center, self.clear_radius);
            if ringed > most {
                most = ringed;
                equals.clear();
            }
            if ringed == most {
                equals.push(center);
            }
        }
        let center = hull::mean(equals.iter().copied());
        let closed = inked_directions(ink, center, self.ring_radius);
        (!equals.is_empty()).then_some((center, closed))
    }

    /// Follows the stroke from a ring to its farthest pixel; `None` if no straight line leads there.
    fn tip(&self, tail: Point, patch: &Patch, ink: &Mask) -> Option<Point> {
        let off = |at: Point| hull::distance(at, tail);
        let pixels = || patch.iter().copied().map(center_of);
        let corner =
            pixels().reduce(|best, next| if off(next) > off(best) { next } else { best })?;
        // A corner of the stroke's end is a little farther off than its middle.
        let is_end = |&at: &Point| {
            off(at) >= off(corner) - 0.5 && hull::distance(at, corner) <= STROKE_PX * self.scale
        };
        let tip = hull::mean(pixels().filter(is_end));
        let length = hull::distance(tail, tip);
        let n_samples = length.ceil() as u32;
        let is_black = |sample: &u32| {
            let share = f64::from(*sample) / f64::from(n_samples);
            let at = [0, 1].map(|axis| (tail[axis] + share * (tip[axis] - tail[axis])) as u32);
            share * length <= self.clear_radius || ink.is_within(1, at[0], at[1])
        };
        let n_black = (0..=n_samples).filter(is_black).count() as f64;
        let is_line = n_black >= LEAST_LINE * f64::from(n_samples + 1);
        (is_line && length >= SHORTEST_PX * self.scale).then_some(tip)
    }
}

/// Counts the directions from a point in which there is ink at the given distance.
fn inked_directions(ink: &Mask, center: Point, radius: f64) -> i32 {
    let is_inked = |direction: &u32| {
        let angle = std::f64::consts::TAU * f64::from(*direction) / f64::from(N_DIRECTIONS);
        let (sin, cos) = angle.sin_cos();
        let at = [center[0] + radius * cos, center[1] + radius * sin];
        at.iter().all(|&value| value >= 0.0) && ink.contains_at(at[0] as u32, at[1] as u32)
    };
    (0..N_DIRECTIONS).filter(is_inked).count() as i32
}
