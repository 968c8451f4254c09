//! Ranks the pulls that a prompt offers.
//!
//! In: a [`ParsedPrompt`] and a [`View`]. Out: every pull within the prompt's rules, most promising first.

use super::estimate::Encoded;
use super::features::{Cloth, NAMES};
use super::parsed_prompt::ParsedPrompt;
use super::view::View;
use super::window::Window;
use super::{middle_of, rim};
use fab_picture::hull;
use fab_program::PixelPoint;
use std::rc::Rc;

/// A possible answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Pull {
    /// Where it begins.
    pub pick: PixelPoint,
    /// Index of the offered direction.
    pub direction: usize,
    /// Index of the offered distance.
    pub distance: usize,
    /// Whether its pick looks like a corner of the cloth itself.
    pub is_sharp: bool,
    /// Its features.
    pub features: [f64; NAMES.len()],
    /// The picture around its pick; pulls of one pick and direction share it.
    pub window: Rc<Window>,
    /// Its expected gain of coverage, as a share of the flat cloth.
    pub gain: f64,
    /// Whether the prompt asks to avoid its pick.
    is_avoided: bool,
}

/// How far a pull may deviate from the outward direction, degrees: half a direction less than a quarter turn.
const OUTWARD_DEG: f64 = 67.0;

/// Safety margin on the prompt's distance limit, pixels: both ends are known only to a pixel.
const SLACK_PX: f64 = 2.0;

/// Cloth share of the circles around a real corner of the cloth; less is the end of a fold.
const SHARP: std::ops::Range<f64> = 0.08..0.38;

/// Returns the pulls that a prompt's rules allow, most promising first. Those of corners to avoid come last, since a
/// task may accept one if there is no other.
pub fn ranked(parsed: &ParsedPrompt, view: &View) -> Vec<Pull> {
    let center = parsed.center.map_or_else(|| rim::center(view), middle_of);
    let cloth = Cloth::new(view, center, parsed.edge_px);
    let mut pulls: Vec<Pull> = parsed
        .corners
        .iter()
        .flat_map(|&pick| of_corner(pick, parsed, &cloth))
        .collect();
    let last = |pull: &Pull| i32::from(pull.is_avoided);
    pulls.sort_by(|a, b| last(a).cmp(&last(b)).then(b.gain.total_cmp(&a.gain)));
    pulls
}

/// Returns the permitted pulls of one corner.
fn of_corner(pick: PixelPoint, parsed: &ParsedPrompt, cloth: &Cloth<'_>) -> Vec<Pull> {
    let from = middle_of(pick);
    let center = cloth.center;
    let corner = cloth.corner(from);
    let is_near =
        |&(point, px): &(PixelPoint, f64)| hull::distance(middle_of(point), from) <= px + SLACK_PX;
    let is_avoided = parsed.avoided.iter().any(is_near);
    let out = [from[0] - center[0], from[1] - center[1]];
    let mut pulls = Vec::new();
    for (direction, heading) in parsed.directions.iter().enumerate() {
        // Rows run down, while a prompt's angles are counter-clockwise.
        let angle = -heading.value.to_radians();
        let (sin, cos) = angle.sin_cos();
        let outward = out[0] * cos + out[1] * sin;
        if outward < OUTWARD_DEG.to_radians().cos() * out[0].hypot(out[1]) {
            continue;
        }
        let measured = cloth.measure(&corner, angle);
        let encoded = Encoded::of(&measured.window);
        for (distance, length) in parsed.distances.iter().enumerate() {
            let length_px = length.value * parsed.edge_px;
            let to = [from[0] + length_px * cos, from[1] + length_px * sin];
            let is_bound = parsed
                .bound
                .is_none_or(|(point, px)| hull::distance(middle_of(point), to) <= px - SLACK_PX);
            if is_bound {
                let features = measured.features(to);
                pulls.push(Pull {
                    pick,
                    direction,
                    distance,
                    is_sharp: SHARP.contains(&corner.cloth_near),
                    features,
                    window: Rc::clone(&measured.window),
                    gain: encoded.gain(&features),
                    is_avoided,
                });
            }
        }
    }
    pulls
}
