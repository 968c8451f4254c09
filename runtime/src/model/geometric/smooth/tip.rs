//! How much a listed point looks like a corner of the cloth itself.
//!
//! In: a [`View`] and a point. Out: a [`Tip`]. Around a corner of a flat square a quarter of a circle is cloth,
//! around a point of its side a half; ends of folds and steps of a slanting side lie between and beyond.

use super::super::frame::Point;
use super::view::{Face, View};

/// What the surroundings of a point look like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tip {
    /// 1 for a sharp corner of the outline, 0 for none.
    pub sharpness: f64,
    /// The flap whose corner it is, where it lies inside of the outline.
    pub flap: Option<Flap>,
}

/// A part of the cloth that is folded over the rest and shows its other face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flap {
    /// Unit vector from its corner to its crease, `[right, down]`.
    pub to_crease: Point,
    /// How far that is, pixels.
    pub height_px: f64,
    /// 1 for a sharp corner, above 0.
    pub sharpness: f64,
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

/// From this share of cloth on a point lies inside of the outline. Ends of creases lie on it, at about a half.
const INSIDE: f64 = 0.7;

/// The least share of its face that a flap's corner has around it.
const LEAST_FLAP: f64 = 0.1;

impl Tip {
    /// Looks at a point, `[column, row]`; `edge_px` is the cloth's side.
    pub fn at(view: &View, point: Point, edge_px: f64) -> Tip {
        let (share, _) = around(view, point, edge_px, |face| face != Face::Table);
        let flaps = [Face::Top, Face::Under].map(|face| flap(view, point, edge_px, face));
        let sharper = |a: &Flap, b: &Flap| a.sharpness.total_cmp(&b.sharpness);
        Tip {
            sharpness: sharpness(share),
            flap: flaps
                .into_iter()
                .flatten()
                .filter(|_| share >= INSIDE)
                .max_by(sharper),
        }
    }
}

/// Follows a face from its corner to where it ends.
fn flap(view: &View, point: Point, edge_px: f64, face: Face) -> Option<Flap> {
    let (share, to_crease) = around(view, point, edge_px, |other| other == face);
    let sharpness = sharpness(share);
    if share < LEAST_FLAP || sharpness <= 0.0 {
        return None;
    }
    let at = |way_px: f64| [0, 1].map(|axis| point[axis] + way_px * to_crease[axis]);
    // The listed point may lie beside its corner.
    let first_px = RADII[0] * edge_px;
    let mut height_px = first_px;
    while height_px < edge_px && view.at(at(height_px)) == face {
        height_px += 1.0;
    }
    (height_px > first_px).then_some(Flap {
        to_crease,
        height_px,
        sharpness,
    })
}

fn sharpness(share: f64) -> f64 {
    if share < SLIM {
        SLIM_SHARPNESS
    } else {
        ((BLUNT - share) / SHARPENING).clamp(0.0, 1.0)
    }
}

/// The share of the circles around a point that shows what is looked for, and in which direction that is.
fn around(view: &View, point: Point, edge_px: f64, is_it: impl Fn(Face) -> bool) -> (f64, Point) {
    let (mut seen, mut sum) = (0.0, [0.0; 2]);
    for step in 0..N_DIRECTIONS {
        let angle = std::f64::consts::TAU * f64::from(step) / f64::from(N_DIRECTIONS);
        let (sin, cos) = angle.sin_cos();
        for radius_px in RADII.map(|radius| radius * edge_px) {
            if is_it(view.at([point[0] + radius_px * cos, point[1] + radius_px * sin])) {
                seen += 1.0;
                sum = [sum[0] + cos, sum[1] + sin];
            }
        }
    }
    let length = sum[0].hypot(sum[1]).max(f64::MIN_POSITIVE);
    let share = seen / (f64::from(N_DIRECTIONS) * RADII.len() as f64);
    (share, sum.map(|value| value / length))
}
