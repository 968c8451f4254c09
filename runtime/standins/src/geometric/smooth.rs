//! Smoothing: pulls the corner that is farthest from the center outward, to where a corner of the flat cloth would lie.
//!
//! In: a conversation whose question offers directions and distances, and lists corners or shows the cloth. Out: a
//! [`Decision`]. Two kinds of sentences limit it: points to stay away from, and how far from a point it may place. It
//! repeats no pull that was refused.

use super::decision::{self, Action, Decision, End};
use super::prompt::{self, Choice};
use super::{all_words, pictures, see, spoken};
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
    let at_centers: Vec<Point> = picks.iter().copied().map(center_of).collect();
    let (middle, _) = hull::rectangle(&at_centers, [1.0, 0.0]);
    let directions = prompt::choices(&question, "direction");
    let pulls = ranked(
        &question,
        &picks,
        &directions,
        center.map_or(middle, center_of),
    )?;
    let (action, corrections) = decision::first_new(&messages[at..], pulls.into_iter());
    Ok(Decision {
        action: action.ok_or("no pull leads outward, ends where the rules allow and was not refused")?,
        picks,
        places: Vec::new(),
        directions,
        center,
        question,
        corrections,
        why: "This is the corner farthest from the center, and it goes outward to where a corner of the flat cloth would lie."
            .to_owned(),
    })
}

/// Ranks the pulls, best first: no corner to avoid, the farthest corner, the most outward direction, the end nearest to
/// where a corner of the flat cloth would lie.
///
/// Pulls that lead inward or too far are left out. A task may accept a corner to avoid if there is no other.
fn ranked(
    question: &str,
    picks: &[PixelPoint],
    directions: &[Choice],
    center: Point,
) -> Result<Vec<Action>, String> {
    let last = |word| prompt::lengths(question, word).pop();
    let (_, side_px) = last("edge").ok_or("no sentence says how many px an edge is")?;
    // Points to avoid, and the least distance from them.
    let (avoided, least_px) = last("away from").unwrap_or_default();
    // Points, and the greatest distance from the first at which a corner may be placed.
    let (reach, most_px) = last("farther than").unwrap_or_default();
    let order = |pick: PixelPoint, direction: &Choice, distance: &Choice| {
        let from = center_of(pick);
        let off_px = hull::distance(from, center).max(f64::MIN_POSITIVE);
        let out = [0, 1].map(|axis| (from[axis] - center[axis]) / off_px);
        let goal = [0, 1].map(|axis| center[axis] + out[axis] * CORNER * side_px);
        // Rows run down, while a prompt's angles are counter-clockwise.
        let (sin, cos) = (-direction.value.to_radians()).sin_cos();
        let outward = out[0] * cos + out[1] * sin;
        let length_px = distance.value * side_px;
        let to = [from[0] + length_px * cos, from[1] + length_px * sin];
        let off = |point: &PixelPoint| hull::distance(center_of(*point), to);
        let is_too_far = reach.first().map(off) > Some(most_px - SLACK_PX);
        if is_too_far || outward < OUTWARD_DEG.to_radians().cos() {
            return None;
        }
        let is_near = |point: &PixelPoint| point.distance_px(pick) <= least_px + SLACK_PX;
        let is_avoided = f64::from(u8::from(avoided.iter().any(is_near)));
        Some([is_avoided, -off_px, -outward, hull::distance(to, goal)])
    };
    let mut pulls = Vec::new();
    for pick in picks {
        for direction in directions {
            for distance in prompt::choices(question, "distance") {
                if let Some(order) = order(*pick, direction, &distance) {
                    let end = End::Pull(direction.clone(), distance);
                    pulls.push((order, Action { pick: *pick, end }));
                }
            }
        }
    }
    pulls.sort_by(|(one, _), (other, _)| one.partial_cmp(other).unwrap_or(Ordering::Equal));
    Ok(pulls.into_iter().map(|(_, action)| action).collect())
}
