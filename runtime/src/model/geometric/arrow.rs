//! The black arrow of a subgoal picture.
//!
//! In: which pixels are near black. Out: the arrow's tail and tip, or why there is not exactly one. An arrow
//! is a stroke with a ring at one end; where the cloth lies does not matter here.

use super::frame;
use super::regions::{self, Grid};
use image::RgbImage;

/// An arrow; points are `[column, row]`, pixels, with pixel centres at halves.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrow {
    /// Centre of the ring.
    pub tail: [f64; 2],
    /// Point of the head.
    pub tip: [f64; 2],
    /// All of its pixels.
    pub stroke: Grid,
}

/// Why there is not exactly one arrow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrowFault {
    /// Nothing looks like an arrow.
    None,
    /// More than one thing does.
    Many,
}

/// The brightest that an arrow's pixel may be, 8-bit levels. Creases of the recorded cloths stay above 90.
const BLACK: u8 = 48;

/// Centre line of the ring and outermost reach of its stroke, pixels of a 224 px picture.
const RING_RADIUS_PX: f64 = 3.0;
const RING_REACH_PX: f64 = 4.5;

/// The shortest arrow, from the ring's centre to the tip, pixels of a 224 px picture; shorter ones are all
/// ring and head.
const SHORTEST_PX: f64 = 9.0;

/// Least share of the line from ring to tip that is black.
const LEAST_LINE: f64 = 0.9;

/// The most black patches, and rings in one, that are looked at; they bound the work on a picture of noise.
const MAX_PATCHES: usize = 64;
const MAX_RINGS: usize = 8;

/// Collects the pixels that an arrow could be drawn with.
pub fn near_black(picture: &RgbImage) -> Grid {
    Grid::from_fn(picture.width(), picture.height(), |column, row| {
        picture.get_pixel(column, row).0.iter().all(|&level| level <= BLACK)
    })
}

/// Finds the only arrow among black pixels.
///
/// `scale` is the picture's longer side over 224 px.
pub fn find(ink: &Grid, scale: f64) -> Result<Arrow, ArrowFault> {
    let mut patches = regions::components(ink);
    patches.retain(|patch| patch.len() as f64 >= SHORTEST_PX * scale);
    patches.sort_by_key(|patch| std::cmp::Reverse(patch.len()));
    patches.truncate(MAX_PATCHES);
    let (mut n_rings, mut found) = (0, None);
    for patch in &patches {
        let mut stroke = Grid::new(ink.width(), ink.height());
        for &(column, row) in patch {
            stroke.insert(column, row);
        }
        let rings = ring_centers(&stroke, patch, scale);
        n_rings += rings.len();
        let mut arrows = rings.into_iter().filter_map(|tail| from_ring(tail, patch, &stroke, scale));
        found = found.or(arrows.next());
    }
    match found {
        None => Err(ArrowFault::None),
        // Of two crossing arrows only one may lead to the farthest pixel, but both have their rings.
        Some(_) if n_rings > 1 => Err(ArrowFault::Many),
        Some(arrow) => Ok(arrow),
    }
}

/// Centres of the rings in a stroke.
fn ring_centers(stroke: &Grid, patch: &[(u32, u32)], scale: f64) -> Vec<[f64; 2]> {
    let columns = || patch.iter().map(|&(column, _)| column);
    let rows = || patch.iter().map(|&(_, row)| row);
    let (Some(left), Some(right)) = (columns().min(), columns().max()) else { return Vec::new() };
    let (Some(top), Some(bottom)) = (rows().min(), rows().max()) else { return Vec::new() };
    // One pixel of margin all round, so that everything outside the stroke hangs together.
    let (width, height) = (right - left + 3, bottom - top + 3);
    let gaps = Grid::from_fn(width, height, |column, row| {
        let at = (column + left).checked_sub(1).zip((row + top).checked_sub(1));
        !at.is_some_and(|(column, row)| stroke.contains(column, row))
    });
    let mut centers: Vec<[f64; 2]> = Vec::new();
    for gap in holes(&gaps) {
        let n_pixels = gap.len() as f64;
        if n_pixels > std::f64::consts::PI * (RING_RADIUS_PX * scale).powi(2) {
            continue;
        }
        let (sum_u, sum_v) = gap.iter().fold((0.0, 0.0), |(u, v), &(column, row)| {
            (u + f64::from(column), v + f64::from(row))
        });
        let center = [
            sum_u / n_pixels + f64::from(left) - 0.5,
            sum_v / n_pixels + f64::from(top) - 0.5,
        ];
        // The line may cut the inside of its own ring in two.
        let is_known = |&known: &[f64; 2]| frame::distance(known, center) <= RING_REACH_PX * scale;
        if !centers.iter().any(is_known) && is_ringed(stroke, center, scale) {
            centers.push(center);
        }
        if centers.len() == MAX_RINGS {
            break;
        }
    }
    centers
}

/// Tells whether ink surrounds a point at a ring's radius. The strokes of an arrowhead may enclose a pixel too,
/// but leave most directions open.
fn is_ringed(stroke: &Grid, center: [f64; 2], scale: f64) -> bool {
    const N_DIRECTIONS: u32 = 16;
    let is_inked = |direction: &u32| {
        let angle = std::f64::consts::TAU * f64::from(*direction) / f64::from(N_DIRECTIONS);
        let (sin, cos) = angle.sin_cos();
        let radius = RING_RADIUS_PX * scale;
        stroke.touches((center[0] + radius * cos) as u32, (center[1] + radius * sin) as u32)
    };
    (0..N_DIRECTIONS).filter(is_inked).count() as u32 >= N_DIRECTIONS - 2
}

/// The patches of gaps that do not reach the rim. Unlike strokes, gaps do not connect across corners.
fn holes(gaps: &Grid) -> Vec<Vec<(u32, u32)>> {
    let mut seen = Grid::new(gaps.width(), gaps.height());
    let mut holes = Vec::new();
    for start in gaps.points() {
        if seen.contains(start.0, start.1) {
            continue;
        }
        seen.insert(start.0, start.1);
        let mut patch = vec![start];
        let mut next = 0;
        while let Some(&(column, row)) = patch.get(next) {
            next += 1;
            let near = [
                (column.wrapping_sub(1), row),
                (column + 1, row),
                (column, row.wrapping_sub(1)),
                (column, row + 1),
            ];
            for (column, row) in near {
                if gaps.contains(column, row) && !seen.contains(column, row) {
                    seen.insert(column, row);
                    patch.push((column, row));
                }
            }
        }
        // The rim is one patch, and the first one found.
        if start != (0, 0) {
            holes.push(patch);
        }
    }
    holes
}

/// Follows the stroke from a ring to its farthest pixel; `None` if no straight line leads there.
fn from_ring(tail: [f64; 2], patch: &[(u32, u32)], stroke: &Grid, scale: f64) -> Option<Arrow> {
    let middle = |&(column, row): &(u32, u32)| [f64::from(column) + 0.5, f64::from(row) + 0.5];
    let tip = patch
        .iter()
        .map(middle)
        .map(|point| (frame::distance(point, tail), point))
        .reduce(|best, next| if next.0 > best.0 { next } else { best })
        .map(|(_, point)| point)?;
    let length = frame::distance(tail, tip);
    if length < SHORTEST_PX * scale {
        return None;
    }
    let n_samples = length.ceil() as u32;
    let is_black = |sample: &u32| {
        let share = f64::from(*sample) / f64::from(n_samples);
        let at = [0, 1].map(|axis| (tail[axis] + share * (tip[axis] - tail[axis])) as u32);
        share * length < RING_REACH_PX * scale || stroke.touches(at[0], at[1])
    };
    let n_black = (0..=n_samples).filter(is_black).count() as f64;
    let is_line = n_black >= LEAST_LINE * f64::from(n_samples + 1);
    // Arrows are thin: a dark blob with a hole in it is none.
    let is_thin = (patch.len() as f64) < 8.0 * scale * (length + 20.0 * scale);
    (is_line && is_thin).then(|| Arrow { tail, tip, stroke: stroke.clone() })
}
