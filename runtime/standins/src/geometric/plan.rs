//! From words and points to a pick and a place.
//!
//! In: an [`Instruction`], the corners that were detected, the center. Out: pairs of listed points, best
//! first. The words name places in the rectangle around the cloth; here that rectangle is fitted around the
//! corners as they lie now, and each place is given to the nearest listed point.

use super::frame::Frame;
use super::words::{Instruction, Sides, Spot};
use fab_picture::hull::{self, Point};
use fab_program::PixelPoint;
use std::f64::consts::{PI, TAU};

/// A pick and a place with what they are off from the words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// A listed corner.
    pub pick: PixelPoint,
    /// Another listed corner, or the center.
    pub place: PixelPoint,
    /// Distance of both from where the words point, added, pixels.
    pub off_px: f64,
}

/// A plan: how the cloth lies, and what could be done.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// How far the cloth is turned against the pictures, radians anti-clockwise, to about a quarter right angle.
    pub turn: f64,
    /// Best first; empty only if nothing is left to choose.
    pub candidates: Vec<Candidate>,
}

/// Why there is no plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoPlan {
    /// The listed corners lie on a line or are fewer than three, and no way between them is like that of the words.
    #[error("the listed corners enclose no area, so I cannot tell how the cloth lies")]
    Shapeless,
    /// The instruction places on the center, of which the prompt says nothing.
    #[error("the instruction speaks of the center, but no center is given")]
    Center,
}

/// What a corner of the rectangle counts as when the words say that the cloth does not reach it, as a share
/// of the short side: about the gap that a corner folded to the middle leaves.
const BARE_GAP: f64 = 0.4;

/// What half a turn against the words costs, in the same unit. Less than one bare corner in a wrong place,
/// because shape tells more than compass words; enough to decide where the shape looks alike either way.
const HALF_TURN: f64 = 0.5;

/// What a rectangle twice as large as necessary would cost, in the same unit: enough to keep a slightly slanted
/// one from winning for being turned less.
const LOOSENESS: f64 = 2.0;

/// What named points that are a short side's length away from all listed ones would cost, in the same unit: they are
/// points of the cloth, so that a rectangle in which nothing lies there is not the one that is meant.
const OFF: f64 = 2.0;

/// How far both may be off for being told in eighths and detected to a pixel, as a share of the short side; that must not
/// outweigh half a turn.
const OFF_BY_ROUNDING: f64 = 0.13;

/// Rectangles that are larger than the snuggest by less than this factor are compared.
const ABOUT_AS_SNUG: f64 = 1.25;

/// How far anti-clockwise the balance point between two turns lies off the middle, radians (3 degrees). A square
/// at exactly 45 degrees can be read both ways; which one is taken shall not hang on a pixel's rounding.
const LEAN: f64 = 3.0 * PI / 180.0;

/// How far a way between two listed points may be turned against that of the words, radians (60 degrees).
const MOST_TURN: f64 = PI / 3.0;

/// The most picks and places that are combined.
const MAX_CHOICES: usize = 24;

/// The points that a prompt lists.
#[derive(Clone, Debug)]
pub struct Listed {
    /// Corners of the cloth as it lies now; they can be picked, and tell how it lies.
    pub corners: Vec<PixelPoint>,
    /// Other points that something may be placed on.
    pub others: Vec<PixelPoint>,
    /// Where the cloth's center was at first.
    pub center: Option<PixelPoint>,
}

/// Ranks the choices that an instruction leaves, given the listed points.
pub fn plan(instruction: &Instruction, listed: &Listed) -> Result<Plan, NoPlan> {
    let Listed {
        corners,
        others,
        center,
    } = listed;
    let target = |frame: &Frame, spot: Spot| match spot {
        Spot::Center => center.map(up),
        Spot::At { along, across } => {
            Some(frame.point_at([f64::from(along) / 8.0, f64::from(across) / 8.0]))
        }
    };
    // How far the nearest listed points are from the two that the words name.
    let off_px = |frame: &Frame| {
        let nearest_to = |spot, points: &mut dyn Iterator<Item = &PixelPoint>| {
            let target = target(frame, spot)?;
            let offs = points.map(|&point| hull::distance(up(point), target));
            offs.min_by(f64::total_cmp)
        };
        let pick = nearest_to(instruction.pick, &mut corners.iter());
        let place = nearest_to(
            instruction.place,
            &mut corners.iter().chain(others).chain(center),
        );
        pick.unwrap_or(0.0) + place.unwrap_or(0.0)
    };
    let hull = hull::around(corners.iter().copied().map(up));
    let Some((frame, turn)) = turn_to(instruction, &hull, off_px) else {
        return by_direction(instruction, listed);
    };
    let target = |spot| target(&frame, spot).ok_or(NoPlan::Center);
    let picks = nearest(corners.iter().copied(), target(instruction.pick)?);
    let places = nearest(
        corners.iter().chain(others).chain(center).copied(),
        target(instruction.place)?,
    );
    let mut candidates: Vec<Candidate> = Vec::new();
    for &(pick_off, pick) in &picks {
        let others = places.iter().filter(|&&(_, place)| place != pick);
        candidates.extend(others.map(|&(place_off, place)| Candidate {
            pick,
            place,
            off_px: pick_off + place_off,
        }));
    }
    candidates.sort_by(|a, b| {
        a.off_px
            .total_cmp(&b.off_px)
            .then((a.pick, a.place).cmp(&(b.pick, b.place)))
    });
    Ok(Plan { turn, candidates })
}

/// Ranks pairs by their direction alone, where the listed corners lie on a line and no rectangle fits.
///
/// Of a sharp triangle the detector may find but two corners; which of them is meant is told by the way from one to
/// the other, as the words have it.
fn by_direction(instruction: &Instruction, listed: &Listed) -> Result<Plan, NoPlan> {
    let in_words = |spot: Spot| match spot {
        Spot::Center => [4.0, 4.0],
        Spot::At { along, across } => [f64::from(along), f64::from(across)],
    };
    let angle = |from: Point, to: Point| (to[1] - from[1]).atan2(to[0] - from[0]);
    let meant = angle(in_words(instruction.pick), in_words(instruction.place))
        + instruction.heading.angle();
    let places: Vec<PixelPoint> = match instruction.place {
        Spot::Center => vec![listed.center.ok_or(NoPlan::Center)?],
        Spot::At { .. } => listed
            .corners
            .iter()
            .chain(&listed.others)
            .copied()
            .collect(),
    };
    let picks = listed.corners.iter().take(MAX_CHOICES);
    let pairs = picks.flat_map(|&pick| {
        places
            .iter()
            .take(MAX_CHOICES)
            .map(move |&place| (pick, place))
    });
    let mut turned: Vec<(f64, Candidate)> = pairs
        .filter(|(pick, place)| pick != place)
        .map(|(pick, place)| {
            let turn = (angle(up(pick), up(place)) - meant + PI).rem_euclid(TAU) - PI;
            let pair = Candidate {
                pick,
                place,
                off_px: 0.0,
            };
            (turn, pair)
        })
        .filter(|(turn, _)| turn.abs() <= MOST_TURN)
        .collect();
    turned.sort_by(|a, b| (a.0 + LEAN).abs().total_cmp(&(b.0 + LEAN).abs()));
    let turn = turned.first().ok_or(NoPlan::Shapeless)?.0;
    Ok(Plan {
        turn,
        candidates: turned.into_iter().map(|(_, candidate)| candidate).collect(),
    })
}

/// Fits a rectangle to the corners with its sides ordered as the words do; returns it and its turn against them.
///
/// A corner that was not detected can make a slanted rectangle the snuggest one, so all that are about as snug
/// are compared with the words, by their shape, their turn, and `off_px`: how far from the named points the nearest
/// listed ones are. `None` if the hull has no area.
fn turn_to(
    instruction: &Instruction,
    hull: &[Point],
    off_px: impl Fn(&Frame) -> f64,
) -> Option<(Frame, f64)> {
    let turns: &[u32] = match instruction.sides {
        Sides::Long => &[0, 2],
        Sides::Equal => &[0, 1, 2, 3],
    };
    let mut best: Option<(f64, Frame, f64)> = None;
    for (fitted, excess) in Frame::fits(hull, ABOUT_AS_SNUG) {
        // For words that speak of long sides, `along` is the longer one, however small the difference.
        let start = match instruction.sides {
            Sides::Long => fitted.with_long_side_first(),
            Sides::Equal => fitted,
        };
        for &quarter_turns in turns {
            let frame = start.turned(quarter_turns);
            let turn = (frame.angle() - instruction.heading.angle() + PI).rem_euclid(TAU) - PI;
            let gaps = frame.corner_gaps(hull).into_iter().zip(instruction.bare);
            let misfit: f64 = gaps
                .map(|(gap, is_bare)| {
                    (gap.min(BARE_GAP) - if is_bare { BARE_GAP } else { 0.0 }).abs()
                })
                .sum();
            let off = (off_px(&frame) / frame.short_side() - OFF_BY_ROUNDING).max(0.0);
            let cost =
                misfit + HALF_TURN * (turn + LEAN).abs() / PI + LOOSENESS * excess + OFF * off;
            if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                best = Some((cost, frame, turn));
            }
        }
    }
    best.map(|(_, frame, turn)| (frame, turn))
}

/// The points nearest to a target, each once, nearest first; equally near ones from the top left.
fn nearest(points: impl Iterator<Item = PixelPoint>, target: Point) -> Vec<(f64, PixelPoint)> {
    let mut ranked: Vec<(f64, PixelPoint)> = points
        .map(|point| (hull::distance(up(point), target), point))
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ranked.dedup_by_key(|&mut (_, point)| point);
    ranked.truncate(MAX_CHOICES);
    ranked
}

fn up(point: PixelPoint) -> Point {
    [f64::from(point.u), -f64::from(point.v)]
}
