//! How well the points cover the table, and how their errors propagate to the rest of it.
//!
//! In: points and their fit. Out: a [`Spread`]. Two rows that lie close together fit as well as a grid does, but they
//! hardly constrain the tilt about them, so a millimetre becomes centimetres at the rim of the table.

use super::fault::Fault;
use super::fit::{Fit, straightened};
use super::sighting::Sighting;
use super::{Terms, plane, rigid};
use nalgebra::Point3;

/// The area covered by points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Their extent along the narrowest strip of the table that contains them, metres.
    pub length_m: f64,
    /// Their extent across that strip, metres.
    pub width_m: f64,
    /// Error amplification in the plane, at the worst place that the window shows and the arm reaches; ratio of
    /// standard deviations.
    pub plane_gain: f64,
    /// Error amplification in height, at the worst such place.
    pub height_gain: f64,
}

/// Number of places along a side of the window at which the amplification is computed.
const N_PLACES: u32 = 9;

/// Computes the spread of points.
pub(super) fn measure(terms: &Terms, fit: &Fit, points: &[Sighting]) -> Result<Spread, Fault> {
    let places = places(terms, fit)?;
    let unknown = [f64::INFINITY; 2];
    let gains: Vec<[f64; 2]> = match fit {
        Fit::Plane { .. } => {
            let gain = plane::Gain::of(points);
            let at = |place: &Place| {
                let gain = gain.as_ref()?;
                Some([
                    gain.in_plane(place.straight_px)?,
                    gain.in_height(place.table)?,
                ])
            };
            places.iter().map(|it| at(it).unwrap_or(unknown)).collect()
        }
        Fit::Rigid { .. } => {
            let gain = rigid::Gain::of(points);
            let at = |place: &Place| gain.as_ref().map(|gain| gain.at(place.table));
            places.iter().map(|it| at(it).unwrap_or(unknown)).collect()
        }
    };
    let worst = |which: usize| gains.iter().map(|gain| gain[which]).fold(0.0, f64::max);
    let [length_m, width_m] = extent_m(points);
    Ok(Spread {
        length_m,
        width_m,
        plane_gain: worst(0),
        height_gain: worst(1),
    })
}

/// A place that the window shows and the arm reaches.
struct Place {
    straight_px: [f64; 2],
    table: Point3<f64>,
}

fn places(terms: &Terms, fit: &Fit) -> Result<Vec<Place>, Fault> {
    let steps = (0..N_PLACES).map(|step| f64::from(step) / f64::from(N_PLACES - 1));
    let pixels = steps.clone().flat_map(|down| {
        steps
            .clone()
            .map(move |right| terms.window.pixel_at([right, down]))
    });
    let place = |pixel: [f64; 2]| {
        Some(Place {
            straight_px: straightened(fit.lens(), pixel)?,
            table: fit.table_from_pixel(pixel)?,
        })
    };
    let shown: Vec<Place> = pixels.filter_map(place).collect();
    let [least, most] = terms.reach_m;
    let is_reached = |place: &Place| {
        let table = [place.table.x, place.table.y];
        (0..2).all(|axis| least[axis] <= table[axis] && table[axis] <= most[axis])
    };
    let bound = |of: fn(f64, f64) -> f64, start: f64| {
        [0, 1].map(|axis| shown.iter().map(|it| it.table[axis]).fold(start, of))
    };
    let shown_m = [
        bound(f64::min, f64::INFINITY),
        bound(f64::max, f64::NEG_INFINITY),
    ];
    let reached: Vec<Place> = shown.into_iter().filter(is_reached).collect();
    if reached.is_empty() {
        return Err(Fault::OutOfReach {
            shown_m,
            reach_m: terms.reach_m,
        });
    }
    Ok(reached)
}

/// Returns the extents of points on the table, metres: across the narrowest strip that contains them, and along it; the
/// longer first.
pub(super) fn extent_m(points: &[Sighting]) -> [f64; 2] {
    let along = |turn_deg: f64| {
        let (sin, cos) = turn_deg.to_radians().sin_cos();
        let places = points
            .iter()
            .map(|point| point.base.x * cos + point.base.y * sin);
        let ends = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), it| {
            (least.min(it), most.max(it))
        });
        (ends.1 - ends.0).max(0.0)
    };
    let turns = (0..180).map(f64::from);
    let sides = turns.map(|turn_deg| [along(turn_deg + 90.0), along(turn_deg)]);
    let narrowest = sides.min_by(|a, b| a[1].total_cmp(&b[1]));
    narrowest.unwrap_or_default()
}
