//! Detects common input mistakes: a mistyped point, swapped axes, millimetres instead of metres.
//!
//! In: points as given. Out: faults that name the point and the likely mistake. Nothing is corrected silently: a
//! mistyped point may also have been touched wrongly.

use super::accuracy::{errors_mm, root_mean_square};
use super::fault::{Fault, MAX_DEPTH_M, MAX_LIMIT_MM};
use super::fit::{Fit, Solver};
use super::sighting::Sighting;
use super::{MIN_PAIRS, Method, Pair, Refusal, Terms};

/// No arm on a table reaches farther than this, metres: twice the largest of the supported ones.
const FAR_M: f64 = 2.0;
/// Pixels closer than this are the same place.
const SAME_PX: f64 = 3.0;
/// The most subsets of four points tried in the search for a consensus.
const MAX_TRIES: usize = 3000;
/// A point agrees with a fit if its error is within this multiple of the limit.
const AGREES: f64 = 3.0;

/// A point's error must be this multiple of the others' to count as a slip; otherwise it is ordinary scatter.
const STANDS_OUT: f64 = 5.0;

/// Rejects points that are invalid on their own, each with its first fault.
pub(super) fn check(terms: &Terms, pairs: &[Pair]) -> Result<(), Refusal> {
    check_terms(terms)?;
    let mut faults: Vec<Fault> = (1..)
        .zip(pairs)
        .filter_map(|(point, pair)| check_numbers(terms, point, pair))
        .collect();
    faults.extend(check_units(pairs, 1));
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
    if places.len() < MIN_PAIRS {
        return Err(Fault::TooFew { n: places.len() }.into());
    }
    if terms.method == Method::Rigid {
        let lacking = || {
            pairs
                .iter()
                .zip(1..)
                .filter(|(pair, _)| pair.depth_m.is_none())
        };
        if let Some((_, first)) = lacking().next() {
            return Err(Fault::NoDepth {
                first,
                n_without: lacking().count(),
                n_all: pairs.len(),
            }
            .into());
        }
    }
    Ok(())
}

fn check_terms(terms: &Terms) -> Result<(), Fault> {
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
    match &terms.intrinsics {
        Some(intrinsics) if intrinsics.size_px != terms.size_px => Err(Fault::IntrinsicsSize {
            stated: intrinsics.size_px,
            size_px: terms.size_px,
        }),
        None if terms.method == Method::Rigid => Err(Fault::NoIntrinsics),
        _ => Ok(()),
    }
}

fn check_numbers(terms: &Terms, point: usize, pair: &Pair) -> Option<Fault> {
    let numbers = pair.pixel.iter().chain(&pair.base_m).chain(&pair.depth_m);
    if !numbers.into_iter().all(|number| number.is_finite()) {
        return Some(Fault::NotFinite { point });
    }
    let is_in = |[u, v]: [f64; 2]| {
        let [width, height] = terms.size_px.map(f64::from);
        (0.0..=width).contains(&u) && (0.0..=height).contains(&v)
    };
    let [u, v] = pair.pixel;
    if !is_in(pair.pixel) {
        let hint = match is_in([v, u]) {
            true => ": are its column and row swapped?",
            false => "",
        };
        return Some(Fault::OutsidePicture {
            point,
            pixel: pair.pixel,
            size_px: terms.size_px,
            hint: hint.to_owned(),
        });
    }
    let depth = pair.depth_m?;
    let is_depth = |depth: f64| depth > 0.0 && depth <= MAX_DEPTH_M;
    (!is_depth(depth)).then(|| Fault::Depth {
        point,
        depth,
        hint: match depth {
            0.0 => ": 0 means that the camera has no reading there; leave it out",
            _ if is_depth(depth / 1000.0) => ": are these millimetres?",
            _ => "",
        },
    })
}

/// Returns the fault of a single point on its own.
pub(super) fn check_numbers_of(terms: &Terms, point: usize, pair: &Pair) -> Option<Fault> {
    let pairs = std::slice::from_ref(pair);
    check_numbers(terms, point, pair).or_else(|| check_units(pairs, point))
}

/// Reports points that are not in metres; `first` is the number of the first point.
fn check_units(pairs: &[Pair], first: usize) -> Option<Fault> {
    let reaches = |base: [f64; 3], per_metre: f64| {
        base.iter()
            .all(|number| (number / per_metre).abs() <= FAR_M)
    };
    let mut far = (first..)
        .zip(pairs)
        .filter(|(_, pair)| !reaches(pair.base_m, 1.0));
    let (point, Pair { base_m, .. }) = far.next()?;
    let units = [("centimetres", 100.0), ("millimetres", 1000.0)];
    // Values within reach in centimetres are within reach in millimetres, too; the larger unit is assumed only if all
    // points fit it.
    let unit = units.into_iter().find(|(_, per_metre)| {
        let others = pairs.iter().filter(|pair| !reaches(pair.base_m, 1.0));
        others
            .into_iter()
            .all(|pair| reaches(pair.base_m, *per_metre))
    });
    Some(match unit {
        Some((unit, _)) => Fault::Unit {
            point,
            base: *base_m,
            unit,
            n_such: 1 + far.count(),
            n_all: pairs.len(),
        },
        None => Fault::TooFar {
            point,
            base: *base_m,
        },
    })
}

/// Names points that contradict the others; `None` if no large part of the points agrees.
pub(super) fn find(terms: &Terms, solver: &Solver, pairs: &[Pair]) -> Option<Refusal> {
    let points = solver.sightings(pairs).ok()?;
    let (fit, agree) = consensus(solver, &points, terms.limit_mm * AGREES)?;
    let agreeing: Vec<Sighting> = agree.iter().map(|index| points[*index]).collect();
    let usual_mm = root_mean_square(&errors_mm(&fit, &agreeing)?);
    let stands_out = |index: &usize| {
        let off = fit
            .error(&points[*index])
            .map_or(f64::INFINITY, |it| it.norm() * 1000.0);
        !agree.contains(index) && off > usual_mm * STANDS_OUT
    };
    let others = (0..pairs.len()).filter(stands_out);
    let faults: Vec<Fault> = others
        .filter_map(|index| slip(terms, solver, &fit, index + 1, pairs))
        .collect();
    (!faults.is_empty()).then_some(Refusal {
        faults,
        fit: Some(Box::new(fit)),
    })
}

/// Finds the fit with the most agreeing points, and these points; at least two thirds must agree.
pub(super) fn consensus(
    solver: &Solver,
    points: &[Sighting],
    within_mm: f64,
) -> Option<(Fit, Vec<usize>)> {
    let agreeing = |fit: &Fit| -> Vec<usize> {
        let off = |point| {
            fit.error(point)
                .map_or(f64::INFINITY, |it| it.norm() * 1000.0)
        };
        (0..points.len())
            .filter(|index| off(&points[*index]) <= within_mm)
            .collect()
    };
    let of = |indices: &[usize]| {
        let chosen: Vec<Sighting> = indices.iter().map(|index| points[*index]).collect();
        solver.fit(&chosen)
    };
    let mut best: Vec<usize> = Vec::new();
    for four in fours(points.len()) {
        let Some(fit) = of(&four) else {
            continue;
        };
        let agree = agreeing(&fit);
        if agree.len() > best.len() {
            best = agree;
        }
    }
    // A fit to four points is noisy, so refit to all agreeing points.
    for _ in 0..5 {
        let next = agreeing(&of(&best)?);
        if next == best {
            break;
        }
        best = next;
    }
    let is_enough = best.len() >= 6 && best.len() * 3 >= points.len() * 2;
    let fit = is_enough.then(|| of(&best))??;
    Some((fit, best))
}

/// Returns subsets of four points: all of them or, if there are too many, an even sample.
fn fours(n: usize) -> Vec<[usize; 4]> {
    let choose =
        |n: usize| n * n.saturating_sub(1) * n.saturating_sub(2) * n.saturating_sub(3) / 24;
    if choose(n) <= MAX_TRIES {
        let mut all = Vec::with_capacity(choose(n));
        for a in 0..n {
            for b in a + 1..n {
                for c in b + 1..n {
                    all.extend((c + 1..n).map(|d| [a, b, c, d]));
                }
            }
        }
        return all;
    }
    // A multiplicative congruential sequence: the same subsets each time, without a random source.
    let mut state = 1_u64;
    let mut draw = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    (0..MAX_TRIES)
        .map(|_| [draw(), draw(), draw(), draw()])
        .collect()
}

/// Describes the fault of a point that contradicts a fit; `None` if the fit cannot locate its pixel.
fn slip(terms: &Terms, solver: &Solver, fit: &Fit, point: usize, pairs: &[Pair]) -> Option<Fault> {
    let pair = &pairs[point - 1];
    let error = fit.error(&solver.sighting(pair)?)?;
    let within_m = terms.limit_mm * AGREES / 1000.0;
    let base = nalgebra::Vector3::from(pair.base_m);
    Some(Fault::Mistake {
        point,
        off_mm: error.norm() * 1000.0,
        shown_m: (base + error).into(),
        base_m: pair.base_m,
        hint: hint(solver, fit, pair, within_m).unwrap_or_else(|| {
            let wrong: Vec<&str> = ["x", "y", "z"]
                .into_iter()
                .zip(error.iter())
                .filter(|(_, off)| off.abs() > within_m)
                .map(|(axis, _)| axis)
                .collect();
            match wrong[..] {
                [axis] => format!("only its {axis} is off: was it typed wrong?"),
                _ => "was it typed wrong, or the tool not at rest?".to_owned(),
            }
        }),
    })
}

/// Finds a single change that makes a point agree.
fn hint(solver: &Solver, fit: &Fit, pair: &Pair, within_m: f64) -> Option<String> {
    let [u, v] = pair.pixel;
    let [x, y, z] = pair.base_m;
    let based = |base_m| Pair { base_m, ..*pair };
    let changes = [
        (
            "its column and row swapped",
            Pair {
                pixel: [v, u],
                ..*pair
            },
        ),
        ("its x and y swapped", based([y, x, z])),
        ("the other sign of its x", based([-x, y, z])),
        ("the other sign of its y", based([x, -y, z])),
        ("the other sign of its z", based([x, y, -z])),
    ];
    let agrees = |changed: &Pair| {
        let error = solver.sighting(changed).and_then(|it| fit.error(&it));
        error.is_some_and(|error| error.norm() <= within_m)
    };
    let found = changes.into_iter().find(|(_, changed)| agrees(changed))?;
    Some(format!("with {} it would fit", found.0))
}

/// Names the likely cause of a mirror image.
pub(super) fn why_mirrored(terms: &Terms, pairs: &[Pair]) -> &'static str {
    let [least, most] = terms.reach_m;
    let n = pairs.len().max(1) as f64;
    let middle = [0, 1].map(|axis| pairs.iter().map(|pair| pair.base_m[axis]).sum::<f64>() / n);
    let is_reached = |change: fn([f64; 2]) -> [f64; 2]| {
        let place = change(middle);
        (0..2).all(|axis| (least[axis]..=most[axis]).contains(&place[axis]))
    };
    let as_given = is_reached(|place| place);
    if !as_given && is_reached(|[x, y]| [y, x]) {
        return "with x and y swapped the points lie in the workspace";
    }
    if !as_given && is_reached(|[x, y]| [x, -y]) {
        return "with the other sign of y the points lie in the workspace";
    }
    if !as_given && is_reached(|[x, y]| [-x, y]) {
        return "with the other sign of x the points lie in the workspace";
    }
    "are columns and rows swapped, or x and y, or is a sign lost, or does the camera mirror its picture?"
}
