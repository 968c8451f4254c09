//! Smoothing: pulls the corner that is farthest from the center outward, to where a corner of the flat cloth would lie.
//!
//! In: a conversation whose question offers directions and distances, and lists corners or shows the cloth. Out: a
//! [`Decision`]. Two kinds of sentences limit it: points to stay away from, and how far from a point it may place.
//! After a correction it takes the next pull that the correction leaves.

use super::decision::{Decision, End};
use super::prompt::{self, Choice};
use super::{Refused, see, spoken};
use fab_model::{Message, Part, Speaker};
use fab_picture::hull::{self, Point};
use fab_program::PixelPoint;
use std::cmp::Ordering;

/// How far a pull may deviate from the outward direction, degrees: half a direction less than a quarter turn.
const OUTWARD_DEG: f64 = 67.0;

/// Distance of a flat cloth's corner from its center, in sides.
const CORNER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Safety margin on distances that the prompt states, pixels: both ends are known only to a pixel.
const SLACK_PX: f64 = 2.0;

/// How far inside the outline a point of the picture is picked, as a fraction of its distance from the middle.
const INWARD: f64 = 0.03;

/// Returns whether a prompt's format has a direction and a distance to choose.
pub fn is_asked(text: &str) -> bool {
    let mut fields = ["direction", "distance"].iter();
    fields.all(|field| !prompt::choices(text, field).is_empty())
}

/// Chooses a pull; fails with the reason.
pub fn choose(messages: &[Message]) -> Result<Decision, String> {
    let shows = |message: &Message| {
        let is_image = |part: &Part| matches!(part, Part::Image(_));
        message.speaker == Speaker::User && message.parts.iter().any(is_image)
    };
    let lists = |message: &Message| message.speaker == Speaker::User && !listed(message).is_empty();
    let at = messages.iter().rposition(lists);
    let at = at.or_else(|| messages.iter().rposition(shows));
    let at = at.ok_or("no corners are listed, and there is no picture")?;
    let texts: Vec<String> = messages[..=at].iter().map(spoken).collect();
    let question = texts.join("\n");
    let limits = Limits::read(&question)?;
    let mut picks = listed(&messages[at]);
    if picks.is_empty() {
        picks = of_picture(&messages[at])?;
    }
    let center = match prompt::center(&question) {
        Some(center) => middle_of(center),
        None => box_center(&picks),
    };
    let refused = Refused::read(&messages[at..]);
    let mut pulls = pulls(&picks, center, &question, &limits);
    pulls.retain(|(pick, direction, distance)| refused.leaves_pull(*pick, direction, distance));
    let (pick, direction, distance) = pulls
        .into_iter()
        .next()
        .ok_or("no pull leads outward, ends where the rules allow and was not refused")?;
    Ok(Decision {
        pick,
        end: End::Pull {
            direction,
            distance,
            offered: prompt::choices(&question, "direction"),
        },
        picks,
        center: prompt::center(&question),
        question,
        corrections: refused.0.len(),
        why: "This is the corner farthest from the center, and it goes outward to where a corner of the flat cloth would lie."
            .to_owned(),
    })
}

/// Returns the corners that a turn lists; a sentence about points to avoid may mention corners, too.
fn listed(message: &Message) -> Vec<PixelPoint> {
    let text = spoken(message);
    let is_list = |line: &&str| !line.contains("away from") && !line.contains("farther than");
    prompt::corners(&text.lines().filter(is_list).collect::<Vec<_>>().join("\n"))
}

/// What a prompt says of lengths in the picture, pixels.
struct Limits {
    /// The cloth's side.
    side_px: f64,
    /// Points to avoid, and the least distance from them.
    avoided: (Vec<PixelPoint>, f64),
    /// A point, and the greatest distance from it at which a corner may be placed.
    reach: Option<(PixelPoint, f64)>,
}

impl Limits {
    fn read(text: &str) -> Result<Limits, String> {
        let side = prompt::lengths(text, "edge").last();
        let (_, side_px) = side.ok_or("no sentence says how many px an edge is")?;
        let avoided = prompt::lengths(text, "away from").last();
        let reach = prompt::lengths(text, "farther than").last();
        Ok(Limits {
            side_px,
            avoided: avoided.unwrap_or_default(),
            reach: reach.and_then(|(points, px)| Some((*points.first()?, px))),
        })
    }
}

/// Lists the pulls that lead outward within the limits: the farthest corner first, then the most outward direction, then
/// the end nearest to where a corner of the flat cloth would lie. Those of corners to avoid come last: a task may accept
/// one if there is no other.
fn pulls(
    picks: &[PixelPoint],
    center: Point,
    question: &str,
    limits: &Limits,
) -> Vec<(PixelPoint, Choice, Choice)> {
    let (points, least_px) = &limits.avoided;
    let mut found = Vec::new();
    for &pick in picks {
        let from = middle_of(pick);
        let off_px = hull::distance(from, center).max(f64::MIN_POSITIVE);
        let out = [0, 1].map(|axis| (from[axis] - center[axis]) / off_px);
        let goal = [0, 1].map(|axis| center[axis] + out[axis] * CORNER * limits.side_px);
        let is_near = |point: &PixelPoint| point.distance_px(pick) <= least_px + SLACK_PX;
        let is_avoided = points.iter().any(is_near);
        for direction in prompt::choices(question, "direction") {
            // Rows run down, while a prompt's angles are counter-clockwise.
            let (sin, cos) = (-direction.value.to_radians()).sin_cos();
            let outward = out[0] * cos + out[1] * sin;
            if outward < OUTWARD_DEG.to_radians().cos() {
                continue;
            }
            for distance in prompt::choices(question, "distance") {
                let length_px = distance.value * limits.side_px;
                let to = [from[0] + length_px * cos, from[1] + length_px * sin];
                let is_within = limits.reach.is_none_or(|(point, most_px)| {
                    hull::distance(middle_of(point), to) <= most_px - SLACK_PX
                });
                if is_within {
                    let order = [-off_px, -outward, hull::distance(to, goal)];
                    found.push((is_avoided, order, (pick, direction.clone(), distance)));
                }
            }
        }
    }
    found.sort_by(|(a, by, _), (b, other, _)| {
        let parts = by.iter().zip(other).map(|(a, b)| a.total_cmp(b));
        a.cmp(b).then(parts.fold(Ordering::Equal, Ordering::then))
    });
    found.into_iter().map(|(.., pull)| pull).collect()
}

/// Returns points a little inside the corners of the cloth's outline in a question's picture.
fn of_picture(question: &Message) -> Result<Vec<PixelPoint>, String> {
    let mut pictures = question.parts.iter().filter_map(|part| match part {
        Part::Image(png) => Some(png),
        Part::Text(_) => None,
    });
    let picture = pictures.next().ok_or("there is no picture")?;
    let outline = see::outline(picture.bytes())?;
    let n_corners = outline.len() as f64;
    let sum = outline.iter().fold([0.0, 0.0], |sum: Point, point| {
        [sum[0] + point[0], sum[1] + point[1]]
    });
    let middle = sum.map(|total| total / n_corners);
    let inward = |corner: &Point| {
        let [u, v] = [0, 1].map(|axis| corner[axis] + INWARD * (middle[axis] - corner[axis]));
        PixelPoint::new(u as i32, v as i32)
    };
    Ok(outline.iter().map(inward).collect())
}

/// The middle of the upright box around points.
fn box_center(points: &[PixelPoint]) -> Point {
    let middle = |of: fn(&PixelPoint) -> i32| {
        let (least, most) = (points.iter().map(of).min(), points.iter().map(of).max());
        (f64::from(least.unwrap_or(0)) + f64::from(most.unwrap_or(0)) + 1.0) / 2.0
    };
    [middle(|point| point.u), middle(|point| point.v)]
}

/// The middle of a pixel.
fn middle_of(pixel: PixelPoint) -> Point {
    [f64::from(pixel.u) + 0.5, f64::from(pixel.v) + 0.5]
}
