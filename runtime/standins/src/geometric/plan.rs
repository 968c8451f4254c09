//! Plans a pick and a place from words and points.
//!
//! In: an [`Instruction`], the detected corners, the center. Out: pairs of listed points, best first. The words name
//! places in the rectangle around the cloth. Here that rectangle is fitted to the current corners, and each place is
//! matched with the nearest listed point.

use super::frame::Frame;
use super::words::{Instruction, Sides, Spot};
use fab_picture::hull::{self, Point};
use fab_program::PixelPoint;
use std::f64::consts::{PI, TAU};

/// A pick and a place with their deviation from the words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// A listed corner.
    pub pick: PixelPoint,
    /// Another listed corner, or the center.
    pub place: PixelPoint,
    /// Summed distance of both from the described places, pixels.
    pub off_px: f64,
}

/// A plan: the cloth's pose, and the possible actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The cloth's rotation relative to the pictures, radians counter-clockwise, accurate to about a quarter of a right
    /// angle.
    pub turn: f64,
    /// Best first; empty only if no choice is left.
    pub candidates: Vec<Candidate>,
}

/// Why there is no plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoPlan {
    /// The listed corners are collinear or fewer than three, and no direction between them matches the words.
    #[error("the listed corners enclose no area, so I cannot tell how the cloth lies")]
    Shapeless,
    /// The instruction places on the center, which the prompt does not state.
    #[error("the instruction speaks of the center, but no center is given")]
    Center,
}

/// Assumed gap between the cloth and a rectangle's corner that is bare according to the words, as a fraction of the
/// short side: about what a corner folded to the middle leaves. Larger gaps count as this.
const BARE_GAP: f64 = 0.4;

/// Cost of a half turn against the words, in the same unit. Less than one wrong bare corner, because shape is more
/// reliable than compass words; enough to decide if the shape is symmetric.
const HALF_TURN: f64 = 0.5;

/// Cost of a rectangle twice as large as necessary, in the same unit: enough to keep a slightly slanted one from
/// winning because it is turned less.
const LOOSENESS: f64 = 2.0;

/// Cost of named points a short side away from all listed ones, in the same unit. Named points are points of the cloth,
/// so a rectangle without points there is not the intended one.
const OFF: f64 = 2.0;

/// How far both may deviate because words use eighths and detection whole pixels, as a fraction of the short side; this
/// must not outweigh a half turn.
const OFF_BY_ROUNDING: f64 = 0.13;

/// Rectangles larger than the tightest by less than this factor are compared.
const ABOUT_AS_SNUG: f64 = 1.25;

/// How far counter-clockwise the balance point between two turns is shifted from the middle, radians (3 degrees). A
/// square at exactly 45 degrees can be read both ways; the choice must not depend on a pixel's rounding.
const LEAN: f64 = 3.0 * PI / 180.0;

/// How far a direction between two listed points may deviate from that of the words, radians (60 degrees).
const MOST_TURN: f64 = PI / 3.0;

/// The most picks and places combined.
const MAX_CHOICES: usize = 24;

/// The points that a prompt lists.
#[derive(Clone, Debug)]
pub struct ListedPoints {
    /// Current corners of the cloth; they can be picked, and show the cloth's pose.
    pub corners: Vec<PixelPoint>,
    /// Other points that can be placed on.
    pub others: Vec<PixelPoint>,
    /// The initial position of the cloth's center.
    pub center: Option<PixelPoint>,
}

/// Ranks the choices for an instruction, given the listed points.
pub fn plan(instruction: &Instruction, listed: &ListedPoints) -> Result<Plan, NoPlan> {
    let ListedPoints {
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
    // Distance of the nearest listed points from the two named in the words.
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

/// Ranks pairs by direction alone, if the listed corners are collinear and no rectangle fits.
///
/// The detector may find only two corners of a sharp triangle; the direction between the points in the words tells
/// which is which.
fn by_direction(instruction: &Instruction, listed: &ListedPoints) -> Result<Plan, NoPlan> {
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

/// Fits a rectangle to the corners with its sides ordered as in the words; returns it and its rotation relative to
/// them.
///
/// With an undetected corner, a slanted rectangle may be the tightest one, so all almost equally tight ones are
/// compared with the words: by their shape, their rotation, and `off_px`, the distance of the listed points from the
/// named ones. `None` if the hull has no area.
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
        // If the words mention long sides, `along` is the longer one, however small the difference.
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

/// The points nearest to a target, each once, nearest first; ties from the top left.
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
