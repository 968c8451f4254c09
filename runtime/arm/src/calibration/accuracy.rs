//! Decides whether points make a calibration, and whether a calibration holds over the settings' table.
//!
//! In: points and their limit; the settings. Out: the errors of the points, each predicted from the others, and how well
//! the table's corners are known; or a [`Refusal`] with each value and its bound. Nothing is corrected silently: a
//! mistyped point may also have been touched wrongly.

use super::fit::{self, Sighting, error, sightings};
use super::{Calibration, MIN_PAIRS, Pair, Terms, Window};
use crate::settings::Settings;
use fab_picture::camera::{Lens, Plane};
use fab_picture::hull;
use nalgebra::{Point3, Vector3};
use serde::Serialize;

/// No arm on a table reaches farther than this, metres: twice the largest of the supported ones.
const FAR_M: f64 = 2.0;
/// Pixels closer than this are the same place.
const SAME_PX: f64 = 3.0;
/// No point may be off by more than this multiple of the limit; one that is was mistyped.
const STANDS_OUT: f64 = 3.0;
/// The most points that are named as contradicting the others; more are no slips.
const MAX_OUTLIERS: usize = 4;
/// The largest limit that may be requested, millimetres: beyond it a fold's corner is missed.
const MAX_LIMIT_MM: f64 = 20.0;
/// The least share of the table's part that tasks see and the arm reaches, over which the points must be spread.
const LEAST_COVER: f64 = 0.4;
/// A smaller part is none, square metres.
const SMALLEST_TABLE_M2: f64 = 1e-3;
/// How far the window's middle may lie from `table.center_m`, millimetres: a window is placed to within a few pixels,
/// and a turned or shifted base frame puts the table elsewhere.
const MAX_MIDDLE_MM: f64 = 50.0;
/// How far the table's middle and corners may be from the height in `table.center_m`, millimetres: fingers that close
/// so far above a cloth miss it.
const MAX_HEIGHT_MM: f64 = 10.0;

/// Why a calibration is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{why}")]
pub struct Refusal {
    /// What is wrong, one fault per line; points are numbered from 1.
    pub why: String,
    /// The fit of the points that agree, if there is one, as a reference for the others.
    pub fit: Option<Box<Plane>>,
}

impl From<String> for Refusal {
    fn from(why: String) -> Refusal {
        Refusal { why, fit: None }
    }
}

/// The errors of points: distances in space between the tool and the fit's position for the pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    /// The error of each point, millimetres, in the order of the points.
    pub residual_mm: Vec<f64>,
    /// The error of each point under the fit of the others, millimetres.
    pub left_out_mm: Vec<f64>,
    /// Root mean square of the errors, millimetres.
    pub rms_mm: f64,
    /// Root mean square of the left-out errors, millimetres.
    pub left_out_rms_mm: f64,
}

impl Accuracy {
    /// Returns the point, numbered from 1, that is farthest from where the others put it, and how far, millimetres.
    pub fn worst(&self) -> (usize, f64) {
        let numbered = (1..).zip(self.left_out_mm.iter().copied());
        let worst = numbered.max_by(|a, b| a.1.total_cmp(&b.1));
        worst.unwrap_or_default()
    }
}

/// A corner of the part of the table that tasks see and the arm reaches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Corner {
    /// Its place by the fit, metres, base frame.
    pub at_m: [f64; 3],
    /// Its height above that of the table's stated middle, millimetres.
    pub above_mm: f64,
    /// How well the points know it, millimetres: the standard error by leaving out each of them (the jackknife).
    pub error_mm: f64,
}

/// The fit of accepted points.
pub(super) struct Fitted {
    pub fit: Plane,
    /// For each point, the fit of the others.
    pub others: Vec<Plane>,
    pub accuracy: Accuracy,
}

/// Fits points; refuses those that are invalid on their own, then those that contradict the others.
pub(super) fn fitted(terms: &Terms, pairs: &[Pair]) -> Result<Fitted, Refusal> {
    let lens = check_terms(terms)?;
    let lens = lens.as_ref();
    let invalid: Vec<String> = (1..)
        .zip(pairs)
        .filter_map(|(point, pair)| terms.check_point(point, pair).err())
        .collect();
    if !invalid.is_empty() {
        return Err(invalid.join("\n").into());
    }
    let mut places: Vec<[f64; 2]> = Vec::new();
    for Pair { pixel, .. } in pairs {
        let is_same = |other: &[f64; 2]| (other[0] - pixel[0]).hypot(other[1] - pixel[1]) < SAME_PX;
        if !places.iter().any(is_same) {
            places.push(*pixel);
        }
    }
    if places.len() < MIN_PAIRS {
        return Err(Refusal::from(format!(
            "{} distinct points are too few: at least {MIN_PAIRS} are needed, because any four points fit exactly; touch \
             a grid of 4 x 4 over the table",
            places.len()
        )));
    }
    let (points, limit_mm) = (sightings(lens, pairs)?, terms.limit_mm);
    let left_out = LeftOut::of(lens, &points);
    let fit = fit::fit(lens, &points);
    if !left_out.agrees(limit_mm)
        && let Some(refusal) = outliers(limit_mm, lens, pairs, &points)
    {
        return Err(refusal);
    }
    let fit = fit.ok_or_else(|| {
        "the points lie on a line, or all but one do, and determine no fit: spread them over the table, as a grid of 4 x 4"
            .to_owned()
    })?;
    let residual_mm: Vec<f64> = points.iter().map(|point| error_mm(&fit, point)).collect();
    let accuracy = Accuracy {
        rms_mm: root_mean_square(&residual_mm),
        left_out_rms_mm: root_mean_square(&left_out.errors_mm),
        residual_mm,
        left_out_mm: left_out.errors_mm.clone(),
    };
    let (worst, worst_mm) = accuracy.worst();
    let against = |why: String| Refusal {
        why,
        fit: Some(Box::new(fit)),
    };
    let others: Option<Vec<Plane>> = left_out.fits.iter().copied().collect();
    let others = others.ok_or_else(|| {
        against(format!(
            "without point {worst} the others do not determine a fit: touch more points, away from their line"
        ))
    })?;
    if left_out.agrees(limit_mm) {
        return Ok(Fitted {
            fit,
            others,
            accuracy,
        });
    }
    Err(against(format!(
        "the points are {:.1} mm from where the others put them (root mean square); at most {limit_mm} mm are accepted: \
         point {worst} is the worst, {worst_mm:.1} mm off; touch it anew, or all with more care",
        accuracy.left_out_rms_mm
    )))
}

/// Returns the lens of the camera, if its projection is known; fails if no points could meet the terms.
pub(super) fn check_terms(terms: &Terms) -> Result<Option<Lens>, String> {
    let limit_mm = terms.limit_mm;
    if !(limit_mm > 0.0 && limit_mm <= MAX_LIMIT_MM) {
        return Err(format!(
            "the limit is {limit_mm} mm; it must be larger than 0 and at most {MAX_LIMIT_MM}; the default is {}",
            super::LIMIT_MM
        ));
    }
    let Some(intrinsics) = &terms.intrinsics else {
        return Ok(None);
    };
    let ([width, height], [stated_width, stated_height]) = (terms.size_px, intrinsics.size_px);
    if intrinsics.size_px != terms.size_px {
        return Err(format!(
            "the camera's intrinsics are for a picture of {stated_width} x {stated_height} px, and the picture has {width} x {height} px"
        ));
    }
    fit::lens(intrinsics).map(Some)
}

impl Terms {
    /// Fails if a point is invalid on its own; `point` is its number.
    pub fn check_point(&self, point: usize, pair: &Pair) -> Result<(), String> {
        let Pair { pixel, base_m, .. } = pair;
        let [width, height] = self.size_px;
        if !pixel.iter().chain(base_m).all(|number| number.is_finite()) {
            return Err(format!("point {point} has a number that is not finite"));
        }
        let is_inside = |(at, side): (&f64, u32)| (0.0..=f64::from(side)).contains(at);
        if !pixel.iter().zip(self.size_px).all(is_inside) {
            return Err(format!(
                "point {point} is at the pixel {:.1}, {:.1}, outside of the picture of {width} x {height} px",
                pixel[0], pixel[1]
            ));
        }
        if base_m.iter().any(|number| number.abs() > FAR_M) {
            return Err(format!(
                "point {point} is at {}, {}, {}; an arm reaches about a metre, and positions are metres",
                base_m[0], base_m[1], base_m[2]
            ));
        }
        Ok(())
    }
}

/// Each point under the fit of the others.
struct LeftOut {
    /// `None` where they do not determine one.
    fits: Vec<Option<Plane>>,
    /// The errors of the points, millimetres.
    errors_mm: Vec<f64>,
}

impl LeftOut {
    fn of(lens: Option<&Lens>, points: &[Sighting]) -> LeftOut {
        let without = |out: usize| fit::fit(lens, &[&points[..out], &points[out + 1..]].concat());
        let fits: Vec<Option<Plane>> = (0..points.len()).map(without).collect();
        let pairs = fits.iter().zip(points);
        let errors_mm =
            pairs.map(|(fit, point)| fit.map_or(f64::INFINITY, |fit| error_mm(&fit, point)));
        LeftOut {
            errors_mm: errors_mm.collect(),
            fits,
        }
    }

    /// Returns whether the points are as near to where the others put them as the limit says.
    fn agrees(&self, limit_mm: f64) -> bool {
        let most_mm = self.errors_mm.iter().copied().fold(0.0, f64::max);
        root_mean_square(&self.errors_mm) <= limit_mm && most_mm <= STANDS_OUT * limit_mm
    }
}

/// Names the few points without which the others agree; `None` if there are none.
fn outliers(
    limit_mm: f64,
    lens: Option<&Lens>,
    pairs: &[Pair],
    points: &[Sighting],
) -> Option<Refusal> {
    let mut kept: Vec<usize> = (0..points.len()).collect();
    let mut removed = Vec::new();
    let chosen = |kept: &[usize]| -> Vec<Sighting> { kept.iter().map(|it| points[*it]).collect() };
    let mut left_out = LeftOut::of(lens, points);
    while !left_out.agrees(limit_mm) {
        if removed.len() == MAX_OUTLIERS || kept.len() < MIN_PAIRS {
            return None;
        }
        // The wrong one is not always the farthest, but without it the others fit best.
        let spread_mm = |out: usize| {
            let Some(fit) = left_out.fits[out] else {
                return f64::INFINITY;
            };
            let others = kept.iter().enumerate().filter(|(index, _)| *index != out);
            let errors = others.map(|(_, point)| error_mm(&fit, &points[*point]));
            root_mean_square(&errors.collect::<Vec<f64>>())
        };
        let spreads: Vec<f64> = (0..kept.len()).map(spread_mm).collect();
        let worst = (0..kept.len()).min_by(|a, b| spreads[*a].total_cmp(&spreads[*b]))?;
        removed.push(kept.remove(worst));
        left_out = LeftOut::of(lens, &chosen(&kept));
    }
    let fit = fit::fit(lens, &chosen(&kept))?;
    removed.sort_unstable();
    let why = removed.iter().map(|index| {
        let (off_mm, given) = (error_mm(&fit, &points[*index]), pairs[*index].base_m);
        let shown = error(&fit, &points[*index]).map_or_else(
            || "beyond the table's horizon".to_owned(),
            |error| {
                let [x, y, z]: [f64; 3] = (Vector3::from(given) + error).into();
                format!("at {x:.4}, {y:.4}, {z:.4}")
            },
        );
        format!(
            "point {} is {off_mm:.1} mm off: the other points put its pixel {shown}, but it was given as {:.4}, {:.4}, {:.4}",
            index + 1,
            given[0],
            given[1],
            given[2]
        )
    });
    Some(Refusal {
        why: why.collect::<Vec<String>>().join("\n"),
        fit: Some(Box::new(fit)),
    })
}

/// Returns the error of a point, millimetres; infinity if the fit puts it beyond the horizon.
fn error_mm(fit: &Plane, point: &Sighting) -> f64 {
    error(fit, point).map_or(f64::INFINITY, |error| error.norm() * 1000.0)
}

/// Returns the root mean square; 0 for no values.
fn root_mean_square(errors: &[f64]) -> f64 {
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    (squares / errors.len().max(1) as f64).sqrt()
}

impl Calibration {
    /// Judges it over the settings' table; returns the table's corners, from the window's top left clockwise.
    ///
    /// Fails if the points mirror the table, lie elsewhere than the settings say, or do not determine its corners.
    pub fn over_table(&self, settings: &Settings) -> Result<[Corner; 4], Refusal> {
        let against = |why: String| Refusal {
            why,
            fit: Some(Box::new(self.fit)),
        };
        let stated = &settings.camera.intrinsics;
        if stated.is_some() && *stated != self.terms.intrinsics {
            return Err(against(format!(
                "the settings state another camera than the calibrated one: `camera.intrinsics` is {stated:?}, and was {:?}; \
                 calibrate anew, or state the camera as it was",
                self.terms.intrinsics
            )));
        }
        let window = Window::from(settings.camera.window_px);
        window.check_in(self.terms.size_px)?;
        let middle_px = window.pixel_at([0.5; 2]);
        // From columns to rows is clockwise; seen from above, from x to y is counter-clockwise. The sign of the map's
        // determinant at a pixel is that of det(H) / w^3.
        let at_middle = self.fit.world_from_pixel * Vector3::new(middle_px[0], middle_px[1], 1.0);
        if self.fit.world_from_pixel.determinant() * at_middle.z >= 0.0 {
            return Err(against(
                "the points make the picture a mirror image of the table, which no camera above it sees: columns and rows are \
                 swapped, or x and y, or a sign is lost, or the camera mirrors its picture"
                    .to_owned(),
            ));
        }
        let shares = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let corners = shares.map(|share| self.corner(settings, window.pixel_at(share)));
        let ([Some(first), Some(second), Some(third), Some(fourth)], Some(middle)) =
            (corners, self.fit.world_from_pixel(middle_px))
        else {
            return Err(against(
                "by the points, a part of the window shows no table but what lies beyond its horizon: their pixels or places \
                 are wrong"
                    .to_owned(),
            ));
        };
        let corners = [first, second, third, fourth];
        let faults = self.faults(settings, &corners, middle);
        if faults.is_empty() {
            Ok(corners)
        } else {
            Err(against(faults.join("\n")))
        }
    }

    /// Returns the place that a pixel shows, drawn in to what the arm reaches; `None` beyond the horizon.
    fn corner(&self, settings: &Settings, pixel: [f64; 2]) -> Option<Corner> {
        let shown = self.fit.world_from_pixel(pixel)?;
        let (least, most) = (settings.workspace.min_m, settings.workspace.max_m);
        let [x, y] = [0, 1].map(|axis| shown[axis].max(least[axis]).min(most[axis]));
        let at = Point3::new(x, y, self.table_height_m([x, y]));
        let pixel = self.fit.pixel_from_world(at)?;
        let squares: f64 = self
            .others
            .iter()
            .map(|other| match other.world_from_pixel(pixel) {
                Some(elsewhere) => (elsewhere - at).norm_squared(),
                None => f64::INFINITY,
            })
            .sum();
        let n = self.others.len() as f64;
        Some(Corner {
            at_m: at.into(),
            above_mm: (at.z - settings.table.center_m[2]) * 1000.0,
            error_mm: ((n - 1.0) / n * squares).sqrt() * 1000.0,
        })
    }

    /// Returns what is wrong with the table by the points.
    fn faults(
        &self,
        settings: &Settings,
        corners: &[Corner; 4],
        middle: Point3<f64>,
    ) -> Vec<String> {
        let mut faults = Vec::new();
        let center = Point3::from(settings.table.center_m);
        let middle_mm = (middle - center).xy().norm() * 1000.0;
        if middle_mm > MAX_MIDDLE_MM {
            faults.push(format!(
                "by the points the window's middle shows {:.3}, {:.3}, {middle_mm:.0} mm from `table.center_m`; at most \
                 {MAX_MIDDLE_MM} mm are accepted: move the window, or the points are in another frame than the arm's base, \
                 or their pixels are of another picture",
                middle.x, middle.y
            ));
        }
        let touched = Point3::new(
            center.x,
            center.y,
            self.table_height_m([center.x, center.y]),
        );
        let places = corners.iter().map(|corner| Point3::from(corner.at_m));
        for place in [touched].into_iter().chain(places) {
            let off_mm = (place.z - center.z).abs() * 1000.0;
            if off_mm > MAX_HEIGHT_MM {
                faults.push(format!(
                    "at {:.3}, {:.3} the points put the table at {:.4} m, {off_mm:.1} mm from the height in `table.center_m`; \
                     at most {MAX_HEIGHT_MM} mm are accepted: level the table, and touch each point with the fingertips on it",
                    place.x, place.y, place.z
                ));
                break;
            }
        }
        let table = area_m2(corners.map(|corner| [corner.at_m[0], corner.at_m[1]]));
        let touched = self
            .pairs
            .iter()
            .map(|pair| [pair.base_m[0], pair.base_m[1]]);
        let covered = area_m2(hull::around(touched)) / table;
        let wider = "touch a grid of 4 x 4 over all that tasks see, as `--grid 4x4` shows it";
        if table < SMALLEST_TABLE_M2 {
            faults.push(
                "the window shows nothing that the arm reaches: move it, or `workspace`".to_owned(),
            );
        } else if covered < LEAST_COVER {
            faults.push(format!(
                "the points cover {:.0} % of the table that the window shows and the arm reaches; at least {:.0} % are needed: {wider}",
                covered * 100.0,
                LEAST_COVER * 100.0
            ));
        }
        let least = corners
            .iter()
            .max_by(|a, b| a.error_mm.total_cmp(&b.error_mm));
        let limit_mm = self.terms.limit_mm;
        if let Some(corner) = least
            && corner.error_mm > limit_mm
        {
            faults.push(format!(
                "at the corner {:.3}, {:.3} the points know the table to {:.1} mm; at most {limit_mm} mm are accepted: {wider}",
                corner.at_m[0], corner.at_m[1], corner.error_mm
            ));
        }
        faults
    }
}

/// Returns the area of a polygon, square metres.
fn area_m2(outline: impl AsRef<[[f64; 2]]>) -> f64 {
    let outline = outline.as_ref();
    let next = outline.iter().cycle().skip(1);
    let doubled = outline
        .iter()
        .zip(next)
        .map(|(a, b)| a[0] * b[1] - b[0] * a[1]);
    doubled.sum::<f64>().abs() / 2.0
}
