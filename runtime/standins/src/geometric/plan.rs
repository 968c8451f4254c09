//! Plans a pick and a place from words and points: stage two of a fold.
//!
//! In: a conversation with an [`Instruction`], the detected corners, the center. Out: a [`Decision`] of listed points. The
//! words name places in the rectangle around the cloth. Here that rectangle is fitted to the current corners, and each
//! place is matched with the nearest listed point.

use super::decision::{self, Action, Decision, End};
use super::frame::Frame;
use super::instruction::{Instruction, Spot};
use super::prompt::{self, Listed};
use super::{all_words, spoken};
use fab_model::{Message, Speaker};
use fab_picture::hull::{self, Point};
use fab_program::PixelPoint;
use std::f64::consts::{PI, TAU};

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

/// A pick and a place.
type Pair = (PixelPoint, PixelPoint);

/// Picks two points according to the last prompt that has an instruction; fails with the reason.
pub fn choose(messages: &[Message]) -> Result<Decision, String> {
    let found = messages.iter().enumerate().rev().find_map(|(at, message)| {
        let text = spoken(message);
        let instruction = text.lines().find_map(Instruction::read)?;
        (message.speaker == Speaker::User).then_some((at, text, instruction))
    });
    let (at, question, instruction) =
        found.ok_or("no line names a point of the cloth to pick and one to place it on")?;
    let listed = prompt::listed(&question);
    if listed.corners.is_empty() {
        return Err("no corners are listed".to_owned());
    }
    let picks = listed.picks(&all_words(&messages[..=at]));
    let (turn, pairs) = plan(&instruction, &listed, &picks)?;
    let actions = pairs.into_iter().map(|(pick, at)| Action {
        pick,
        end: End::Place(at),
    });
    let (action, corrections) = decision::first_new(&messages[at..], actions);
    Ok(Decision {
        action: action.ok_or("every likely pair of listed points was refused")?,
        places: listed.places(),
        picks,
        directions: Vec::new(),
        center: listed.center,
        question,
        corrections,
        why: format!(
            "The rectangle around the listed corners lies turned by about {:.0} degrees against the words; in it, these \
             are the listed points nearest to the two that the words name, without those that were refused.",
            turn.to_degrees(),
        ),
    })
}

/// Ranks the pairs for an instruction, best first; returns the cloth's rotation relative to the pictures, too, radians
/// counter-clockwise.
fn plan(
    instruction: &Instruction,
    listed: &Listed,
    picks: &[PixelPoint],
) -> Result<(f64, Vec<Pair>), String> {
    let places = listed.places();
    let pairs = picks
        .iter()
        .flat_map(|pick| places.iter().map(|place| (*pick, *place)));
    let mut pairs: Vec<Pair> = pairs.filter(|(pick, place)| pick != place).collect();
    let ends = [instruction.pick, instruction.place];
    let target = |frame: &Frame, spot: Spot| match spot {
        None => listed.center.map(up),
        Some(eighths) => Some(frame.point_at(eighths)),
    };
    // Distance of the nearest listed points from the two named in the words.
    let off_px = |frame: &Frame| {
        let nearest = |spot, points: &[PixelPoint]| {
            let target = target(frame, spot)?;
            let offs = points
                .iter()
                .map(|&point| hull::distance(up(point), target));
            offs.min_by(f64::total_cmp)
        };
        let pick = nearest(ends[0], picks).unwrap_or(0.0);
        pick + nearest(ends[1], &places).unwrap_or(0.0)
    };
    let hull = hull::around(listed.corners.iter().copied().map(up));
    if let Some((frame, turn)) = turn_to(instruction, &hull, off_px) {
        let [Some(from), Some(to)] = ends.map(|spot| target(&frame, spot)) else {
            return Err("the instruction speaks of the center, but no center is given".to_owned());
        };
        let off = |pair: &Pair| hull::distance(up(pair.0), from) + hull::distance(up(pair.1), to);
        pairs.sort_by(|a, b| off(a).total_cmp(&off(b)).then(a.cmp(b)));
        return Ok((turn, pairs));
    }
    // The detector may find only two corners of a sharp triangle; then the direction between the points in the words
    // tells which is which.
    let direction = |[from, to]: [Point; 2]| (to[1] - from[1]).atan2(to[0] - from[0]);
    let in_words = ends.map(|spot| spot.unwrap_or([4, 4]).map(f64::from));
    let meant = direction(in_words) + instruction.heading_rad();
    let turn = |pair: &Pair| {
        let found = direction([up(pair.0), up(pair.1)]);
        (found - meant + PI).rem_euclid(TAU) - PI
    };
    let to_center = instruction.place.is_none();
    pairs.retain(|pair| {
        (Some(pair.1) == listed.center) == to_center && turn(pair).abs() <= MOST_TURN
    });
    pairs.sort_by(|a, b| (turn(a) + LEAN).abs().total_cmp(&(turn(b) + LEAN).abs()));
    let best = pairs
        .first()
        .ok_or("the listed corners enclose no area, so I cannot tell how the cloth lies")?;
    Ok((turn(best), pairs))
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
    let mut best: Option<(f64, Frame, f64)> = None;
    for (fitted, excess) in Frame::fits(hull, ABOUT_AS_SNUG) {
        for frame in (0..4).map(|quarter_turns| fitted.turned(quarter_turns)) {
            // If the words mention long sides, `along` is the longer one, however small the difference.
            if instruction.is_long && !frame.is_along_long_side() {
                continue;
            }
            let meant = instruction.heading_rad();
            let turn = (frame.angle() - meant + PI).rem_euclid(TAU) - PI;
            let gaps = frame.corner_gaps(hull).into_iter().zip(instruction.bare);
            let misfits = gaps.map(|(gap, is_bare)| {
                (gap.min(BARE_GAP) - if is_bare { BARE_GAP } else { 0.0 }).abs()
            });
            let off = (off_px(&frame) / frame.short_side() - OFF_BY_ROUNDING).max(0.0);
            let cost = misfits.sum::<f64>()
                + HALF_TURN * (turn + LEAN).abs() / PI
                + LOOSENESS * excess
                + OFF * off;
            if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                best = Some((cost, frame, turn));
            }
        }
    }
    best.map(|(_, frame, turn)| (frame, turn))
}

fn up(point: PixelPoint) -> Point {
    [f64::from(point.u), -f64::from(point.v)]
}
