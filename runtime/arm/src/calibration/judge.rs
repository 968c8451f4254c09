//! Decides whether points make a calibration.
//!
//! In: points and terms. Out: the fit with its accuracy; or a refusal. Points that are invalid on their own come first,
//! then points that contradict the others, then every value beyond its bound. Nothing is corrected silently: a mistyped
//! point may also have been touched wrongly.

use super::accuracy::{Accuracy, left_out, measure, root_mean_square};
use super::fault::{Fault, MAX_LIMIT_MM, Refusal};
use super::fit::{self, Sighting, error, sightings};
use super::{MIN_PAIRS, Pair, Terms};
use fab_picture::camera::{Lens, Plane};
use nalgebra::Vector3;

/// No arm on a table reaches farther than this, metres: twice the largest of the supported ones.
const FAR_M: f64 = 2.0;
/// Pixels closer than this are the same place.
const SAME_PX: f64 = 3.0;
/// The most points that are named as contradicting the others; more are no slips.
const MAX_OUTLIERS: usize = 4;
/// A named point is off by this multiple of the limit.
const STANDS_OUT: f64 = 3.0;

/// Fits points and judges the fit.
pub(super) fn judge(terms: &Terms, pairs: &[Pair]) -> Result<(Plane, Accuracy), Refusal> {
    let lens = check(terms, pairs)?;
    let points = sightings(&lens, pairs)?;
    let fit = fit::fit(&lens, &points).ok_or(Fault::Undetermined)?;
    let against = |faults: Vec<Fault>| Refusal {
        faults,
        fit: Some(Box::new(fit)),
    };
    let accuracy = measure(terms, &lens, &fit, &points);
    let agrees = accuracy
        .as_ref()
        .is_ok_and(|accuracy| accuracy.checks[..2].iter().all(|check| check.holds()));
    if !agrees && let Some(refusal) = outliers(terms, &lens, pairs, &points) {
        return Err(refusal);
    }
    if !sees_from_above(terms, &fit) {
        return Err(against(vec![Fault::Mirrored]));
    }
    let accuracy = accuracy.map_err(|fault| against(vec![fault]))?;
    let beyond = accuracy.checks.iter().filter(|check| !check.holds());
    let faults: Vec<Fault> = beyond.cloned().map(Fault::Beyond).collect();
    match faults.is_empty() {
        true => Ok((fit, accuracy)),
        false => Err(against(faults)),
    }
}

/// Rejects terms and points that are invalid on their own; returns the camera's lens.
fn check(terms: &Terms, pairs: &[Pair]) -> Result<Lens, Refusal> {
    let lens = check_terms(terms)?;
    let faults: Vec<Fault> = (1..)
        .zip(pairs)
        .filter_map(|(point, pair)| check_point(terms, point, pair))
        .collect();
    if !faults.is_empty() {
        return Err(Refusal { faults, fit: None });
    }
    let mut places: Vec<[f64; 2]> = Vec::new();
    for Pair { pixel, .. } in pairs {
        let is_same = |other: &[f64; 2]| (other[0] - pixel[0]).hypot(other[1] - pixel[1]) < SAME_PX;
        if !places.iter().any(is_same) {
            places.push(*pixel);
        }
    }
    match places.len() < MIN_PAIRS {
        true => Err(Fault::TooFew { n: places.len() }.into()),
        false => Ok(lens),
    }
}

/// Returns the lens of the stated camera; fails if the terms cannot be met by any points.
pub(super) fn check_terms(terms: &Terms) -> Result<Lens, Fault> {
    let limit_mm = terms.limit_mm;
    if !(limit_mm > 0.0 && limit_mm <= MAX_LIMIT_MM) {
        return Err(Fault::Limit { limit_mm });
    }
    if !terms.window.is_in(terms.size_px) {
        return Err(Fault::Window {
            left: terms.window.left_px,
            top: terms.window.top_px,
            side: terms.window.side_px,
            size_px: terms.size_px,
        });
    }
    let stated = [
        ("camera.intrinsics", terms.intrinsics.is_some()),
        ("camera.height_m", terms.height_m.is_some()),
        ("camera.up_deg", terms.up_deg.is_some()),
    ];
    let missing = stated.iter().filter(|(_, is_stated)| !is_stated);
    let keys: Vec<&str> = missing.map(|(key, _)| *key).collect();
    let Some(intrinsics) = terms.intrinsics.as_ref().filter(|_| keys.is_empty()) else {
        return Err(Fault::NotStated { keys });
    };
    if intrinsics.size_px != terms.size_px {
        return Err(Fault::IntrinsicsSize {
            stated: intrinsics.size_px,
            size_px: terms.size_px,
        });
    }
    fit::lens(intrinsics)
}

/// Returns the fault of a single point on its own.
pub(super) fn check_point(terms: &Terms, point: usize, pair: &Pair) -> Option<Fault> {
    let mut numbers = pair.pixel.iter().chain(&pair.base_m);
    if !numbers.all(|number| number.is_finite()) {
        return Some(Fault::NotFinite { point });
    }
    let inside = pair.pixel.iter().zip(terms.size_px);
    if !inside
        .into_iter()
        .all(|(at, side)| (0.0..=f64::from(side)).contains(at))
    {
        return Some(Fault::OutsidePicture {
            point,
            pixel: pair.pixel,
            size_px: terms.size_px,
        });
    }
    let is_far = pair.base_m.iter().any(|number| number.abs() > FAR_M);
    is_far.then_some(Fault::TooFar {
        point,
        base: pair.base_m,
    })
}

/// Names the few points without which the others fit; `None` if there are none.
fn outliers(terms: &Terms, lens: &Lens, pairs: &[Pair], points: &[Sighting]) -> Option<Refusal> {
    let limit_mm = terms.limit_mm;
    let mut kept: Vec<usize> = (0..points.len()).collect();
    for _ in 0..MAX_OUTLIERS.min(points.len().saturating_sub(MIN_PAIRS - 1)) {
        let chosen =
            |kept: &[usize]| -> Vec<Sighting> { kept.iter().map(|it| points[*it]).collect() };
        let errors = left_out(lens, &chosen(&kept)).ok()?;
        let worst = (0..kept.len()).max_by(|a, b| errors[*a].total_cmp(&errors[*b]))?;
        kept.remove(worst);
        let errors = left_out(lens, &chosen(&kept)).ok()?;
        if root_mean_square(&errors) > limit_mm {
            continue;
        }
        let fit = fit::fit(lens, &chosen(&kept))?;
        let removed = (0..points.len()).filter(|index| !kept.contains(index));
        let faults: Vec<Fault> = removed
            .map(|index| {
                let error = error(&fit, &points[index])?;
                let off_mm = error.norm() * 1000.0;
                (off_mm > STANDS_OUT * limit_mm).then(|| Fault::Outlier {
                    point: index + 1,
                    off_mm,
                    shown_m: (Vector3::from(pairs[index].base_m) + error).into(),
                    base_m: pairs[index].base_m,
                })
            })
            .collect::<Option<_>>()?;
        return Some(Refusal {
            faults,
            fit: Some(Box::new(fit)),
        });
    }
    None
}

/// Returns whether the camera sees the table from above, rather than its mirror image.
fn sees_from_above(terms: &Terms, fit: &Plane) -> bool {
    // From columns to rows is clockwise; seen from above, from x to y is counter-clockwise.
    let [u, v] = terms.window.pixel_at([0.5; 2]);
    let factor = (fit.world_from_pixel * Vector3::new(u, v, 1.0)).z;
    // The sign of the map's local determinant there is that of det(H) / w^3.
    fit.world_from_pixel.determinant() * factor < 0.0
}
