//! Smoothing: pulls the corner that is farthest from the center outward, to where a corner of the flat cloth would lie.
//!
//! In: a conversation whose question offers directions and distances, and lists corners or shows the cloth. Out: a
//! [`Decision`]. Two kinds of sentences limit it: points to stay away from, and how far from a point it may place. It
//! repeats no pull that was refused.

use super::decision::{Decision, End};
use super::prompt::{self, Choice};
use super::{all_words, pictures, refused, see, spoken};
use fab_model::{Message, Speaker};
use fab_picture::camera::center_of;
use fab_picture::hull::{self, Point};
use fab_program::PixelPoint;
use std::cmp::Ordering;

/// How far a pull may deviate from the outward direction, degrees: half a direction less than a quarter turn.
const OUTWARD_DEG: f64 = 67.0;

/// Distance of a flat cloth's corner from its center, in sides.
const CORNER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Safety margin on distances that the prompt states, pixels: both ends are known only to a pixel.
const SLACK_PX: f64 = 2.0;

/// Returns whether a prompt's format has a direction and a distance to choose.
pub fn is_asked(text: &str) -> bool {
    let mut fields = ["direction", "distance"].iter();
    fields.all(|field| !prompt::choices(text, field).is_empty())
}

/// Chooses a pull; fails with the reason.
pub fn choose(messages: &[Message]) -> Result<Decision, String> {
    let corners = |message: &Message| prompt::listed(&spoken(message)).corners;
    let last = |is_it: &dyn Fn(&Message) -> bool| {
        messages
            .iter()
            .rposition(|it| it.speaker == Speaker::User && is_it(it))
    };
    let at = last(&|it| !corners(it).is_empty())
        .or_else(|| last(&|it| !pictures(it).is_empty()))
        .ok_or("no corners are listed, and there is no picture")?;
    let question = all_words(&messages[..=at]);
    let mut picks = corners(&messages[at]);
    if picks.is_empty() {
        picks = see::corners(pictures(&messages[at])[0])?;
    }
    let center = prompt::listed(&question).center;
    let last = |word| prompt::lengths(&question, word).pop();
    let (_, side_px) = last("edge").ok_or("no sentence says how many px an edge is")?;
    let rules = Rules {
        center: center.map_or_else(|| box_center(&picks), center_of),
        side_px,
        avoided: last("away from").unwrap_or_default(),
        reach: last("farther than").unwrap_or_default(),
    };
    let refused = refused(&messages[at..]);
    let is_new = |(pick, direction, distance): Pull<'_>| {
        refused.iter().all(|answer| {
            let is_stated = |field, it| prompt::choices(answer, field).first() == Some(it);
            prompt::points(answer).first() != Some(&pick)
                || !is_stated("direction", direction)
                || !is_stated("distance", distance)
        })
    };
    let offered = prompt::choices(&question, "direction");
    let distances = prompt::choices(&question, "distance");
    let moves = || {
        offered
            .iter()
            .flat_map(|it| distances.iter().map(move |at| (it, at)))
    };
    let pulls = picks
        .iter()
        .flat_map(|pick| moves().map(move |(it, at)| (*pick, it, at)));
    let allowed = pulls.filter_map(|pull| Some((rules.order(pull)?, pull)));
    let new = allowed.filter(|(_, pull)| is_new(*pull));
    let best = new.min_by(|(one, _), (other, _)| one.partial_cmp(other).unwrap_or(Ordering::Equal));
    let (_, (pick, direction, distance)) =
        best.ok_or("no pull leads outward, ends where the rules allow and was not refused")?;
    Ok(Decision {
        pick,
        end: End::Pull {
            direction: direction.clone(),
            distance: distance.clone(),
            offered,
        },
        picks,
        center,
        question,
        corrections: refused.len(),
        why: "This is the corner farthest from the center, and it goes outward to where a corner of the flat cloth would lie."
            .to_owned(),
    })
}

/// A corner, a direction and a distance.
type Pull<'a> = (PixelPoint, &'a Choice, &'a Choice);

/// What a prompt says of the picture, pixels.
struct Rules {
    center: Point,
    /// The cloth's side.
    side_px: f64,
    /// Points to avoid, and the least distance from them.
    avoided: (Vec<PixelPoint>, f64),
    /// Points, and the greatest distance from the first at which a corner may be placed.
    reach: (Vec<PixelPoint>, f64),
}

impl Rules {
    /// Returns numbers of which the least belong to the best pull: no corner to avoid, the farthest corner, the most
    /// outward direction, the end nearest to where a corner of the flat cloth would lie. `None` if a pull leads inward
    /// or too far. A task may accept a corner to avoid if there is no other.
    fn order(&self, (pick, direction, distance): Pull<'_>) -> Option<[f64; 4]> {
        let (from, center) = (center_of(pick), self.center);
        let off_px = hull::distance(from, center).max(f64::MIN_POSITIVE);
        let out = [0, 1].map(|axis| (from[axis] - center[axis]) / off_px);
        let goal = [0, 1].map(|axis| center[axis] + out[axis] * CORNER * self.side_px);
        // Rows run down, while a prompt's angles are counter-clockwise.
        let (sin, cos) = (-direction.value.to_radians()).sin_cos();
        let outward = out[0] * cos + out[1] * sin;
        let length_px = distance.value * self.side_px;
        let to = [from[0] + length_px * cos, from[1] + length_px * sin];
        let (reach, most_px) = &self.reach;
        let mut reach = reach
            .iter()
            .take(1)
            .map(|point| hull::distance(center_of(*point), to));
        if outward < OUTWARD_DEG.to_radians().cos() || reach.any(|px| px > most_px - SLACK_PX) {
            return None;
        }
        let (points, least_px) = &self.avoided;
        let is_near = |point: &PixelPoint| point.distance_px(pick) <= least_px + SLACK_PX;
        let avoided = f64::from(u8::from(points.iter().any(is_near)));
        Some([avoided, -off_px, -outward, hull::distance(to, goal)])
    }
}

/// The middle of the upright box around points.
fn box_center(points: &[PixelPoint]) -> Point {
    let middle = |of: fn(&PixelPoint) -> i32| {
        let (least, most) = (points.iter().map(of).min(), points.iter().map(of).max());
        (f64::from(least.unwrap_or(0)) + f64::from(most.unwrap_or(0)) + 1.0) / 2.0
    };
    [middle(|point| point.u), middle(|point| point.v)]
}
