//! How much a listed point looks like a corner of the cloth itself.
//!
//! In: a [`View`] and a point. Out: a [`Tip`]. Around a corner of a flat square a quarter of a circle is cloth,
//! around a point of its side a half; ends of folds and steps of a slanting side lie between and beyond.

use super::super::frame::Point;
use super::view::{Face, View};

/// What the surroundings of a point look like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip {
    /// 1 for a sharp corner, 0 for none.
    pub sharpness: f64,
    /// Whether it is the corner of a face that lies on the cloth, and not of the cloth's outline.
    pub is_flap: bool,
}

/// Radii of the circles that are looked at, as shares of the cloth's side.
const RADII: [f64; 3] = [0.045, 0.07, 0.1];

/// Points that are looked at on each circle.
const N_DIRECTIONS: u32 = 64;

/// From this share of cloth on a point is no corner at all; and by how much less it is a sharp one.
const BLUNT: f64 = 0.44;
const SHARPENING: f64 = 0.12;

/// What is slimmer than this is the end of a fold, and how much that counts as a corner.
const SLIM: f64 = 0.08;
const SLIM_SHARPNESS: f64 = 0.3;

/// From this share of cloth on a point lies inside of the outline, and its face may have a corner there; how
/// much that counts against one of the outline.
const INSIDE: f64 = 0.36;
const FLAP_SHARPNESS: f64 = 0.9;

/// The least share of its face that a flap's corner has around it.
const LEAST_FLAP: f64 = 0.1;

impl Tip {
    /// Looks at a point, `[column, row]`; `edge_px` is the cloth's side.
    pub fn at(view: &View, point: Point, edge_px: f64) -> Tip {
        let share = share_around(view, point, edge_px, |face| face != Face::Table);
        let outer = sharpness(share);
        let flaps = [Face::Top, Face::Under].map(|face| {
            let own = share_around(view, point, edge_px, |other| other == face);
            if share > INSIDE && own >= LEAST_FLAP {
                FLAP_SHARPNESS * sharpness(own)
            } else {
                0.0
            }
        });
        let flap = flaps[0].max(flaps[1]);
        Tip {
            sharpness: outer.max(flap),
            is_flap: flap > outer,
        }
    }
}

fn sharpness(share: f64) -> f64 {
    if share < SLIM {
        SLIM_SHARPNESS
    } else {
        ((BLUNT - share) / SHARPENING).clamp(0.0, 1.0)
    }
}

/// The share of the circles around a point that shows what is looked for.
fn share_around(view: &View, point: Point, edge_px: f64, is_it: impl Fn(Face) -> bool) -> f64 {
    let angles = (0..N_DIRECTIONS)
        .map(|step| std::f64::consts::TAU * f64::from(step) / f64::from(N_DIRECTIONS));
    let around = angles.flat_map(|angle| {
        let (sin, cos) = angle.sin_cos();
        RADII.map(|radius| {
            let radius_px = radius * edge_px;
            [point[0] + radius_px * cos, point[1] + radius_px * sin]
        })
    });
    let seen = around.filter(|&at| is_it(view.at(at))).count();
    seen as f64 / (f64::from(N_DIRECTIONS) * RADII.len() as f64)
}
