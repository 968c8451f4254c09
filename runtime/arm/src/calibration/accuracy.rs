//! Decides whether points make a calibration, and whether a calibration holds over the settings' table.
//!
//! In: points and their limit; the settings. Out: a calibration with each point's error by the others, and how well the
//! table's corners are known; or the first value that is beyond its bound. Nothing is corrected silently: a mistyped
//! point may also have been touched wrongly.

use super::view::{check_window, pixel_at};
use super::{Calibration, Pair, Terms, UNDETERMINED, fit};
use crate::settings::Settings;
use fab_picture::camera::Plane;
use image::GrayImage;
use nalgebra::{Point3, Vector3};
use serde::Serialize;

/// The fewest distinct points accepted.
///
/// Four points fit a homography exactly, whatever was typed; only with twice as many is leaving one out informative.
const MIN_PAIRS: usize = 8;
/// Pixels closer than this are the same place.
const SAME_PX: f64 = 3.0;
/// How far the window's middle may lie from `table.center_m`, millimetres: a window is placed to within a few pixels,
/// and a turned or shifted base frame puts the table elsewhere.
const MAX_MIDDLE_MM: f64 = 50.0;
/// How far the table's corners may be from the height in `table.center_m`, millimetres: fingers that close
/// so far above a cloth miss it.
const MAX_HEIGHT_MM: f64 = 10.0;

/// A corner of the part of the table that tasks see and the arm reaches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Corner {
    /// Its place by the fit, metres, base frame.
    pub at_m: [f64; 3],
    /// How well the points know it, millimetres: the standard error by leaving out each of them (the jackknife).
    pub error_mm: f64,
}

impl Calibration {
    /// Fits the map from pixels to the base frame to points; fails if they are too few or disagree.
    ///
    /// - `made_on`: the date, UTC, e.g. `2026-11-22`.
    /// - `reference`: the camera's picture of the table, in the size stated by the terms.
    pub fn make(
        terms: Terms,
        pairs: Vec<Pair>,
        made_on: &str,
        reference: Option<GrayImage>,
    ) -> Result<Calibration, String> {
        let ([width, height], limit_mm) = (terms.size_px, terms.limit_mm);
        if let Some(picture) = &reference
            && [picture.width(), picture.height()] != terms.size_px
        {
            return Err(format!(
                "the picture has {} x {} px, and the camera's pictures {width} x {height} px",
                picture.width(),
                picture.height()
            ));
        }
        let n_places = count_places(&pairs);
        if n_places < MIN_PAIRS {
            return Err(format!(
                "{n_places} distinct points are too few: at least {MIN_PAIRS} are needed, because any four points fit \
                 exactly; touch a grid of 4 x 4 over the table"
            ));
        }
        let lens = terms.lens()?;
        let points = terms.straightened(lens.as_ref(), &pairs)?;
        let without = |out: usize| [&points[..out], &points[out + 1..]].concat();
        let others = (0..points.len()).map(|out| fit::fit(lens.as_ref(), &without(out)));
        let others: Vec<Option<Plane>> = others.collect();
        let error_mm = |fit: &Option<Plane>, point: &Pair| {
            fit.map_or(f64::INFINITY, |fit| fit::error_mm(&fit, point))
        };
        let left_out_mm = others.iter().zip(&points);
        let left_out_mm: Vec<f64> = left_out_mm
            .map(|(fit, point)| error_mm(fit, point))
            .collect();
        let rms_mm = root_mean_square(left_out_mm.iter().copied());
        if rms_mm <= limit_mm
            && let Some(fit) = fit::fit(lens.as_ref(), &points)
        {
            return Ok(Calibration {
                terms,
                made_on: made_on.to_owned(),
                pairs,
                fit,
                others: others.into_iter().flatten().collect(),
                left_out_mm,
                reference,
            });
        }
        // The wrong point is not always the farthest, but without it the others agree best.
        let agreement_mm = |out: usize| {
            let rest = without(out);
            root_mean_square(rest.iter().map(|point| error_mm(&others[out], point)))
        };
        let judged = (1..).zip((0..points.len()).map(agreement_mm));
        let (suspect, agreement_mm) = judged
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .unwrap_or_default();
        if agreement_mm.is_infinite() {
            return Err(UNDETERMINED.to_owned());
        }
        let off = if rms_mm.is_finite() {
            format!("{rms_mm:.1} mm from where the others put them (root mean square)")
        } else {
            "partly beyond the horizon by the others".to_owned()
        };
        Err(format!(
            "the points are {off}; at most {limit_mm} mm are accepted: without point {suspect} the others agree to \
             {agreement_mm:.1} mm; touch it anew, or all with more care"
        ))
    }

    /// Returns the root mean square of the points' errors by the others, millimetres.
    pub fn left_out_rms_mm(&self) -> f64 {
        root_mean_square(self.left_out_mm.iter().copied())
    }

    /// Judges it over the settings' table; returns the table's corners, from the window's top left clockwise.
    ///
    /// Fails if the points mirror the table, lie elsewhere than the settings say, or do not determine its corners.
    pub fn over_table(&self, settings: &Settings) -> Result<[Corner; 4], String> {
        let window = settings.camera.window_px;
        check_window(window, self.terms.size_px)?;
        let middle_px = pixel_at(window, [0.5; 2]);
        // From columns to rows is clockwise; seen from above, from x to y is counter-clockwise. The sign of the map's
        // determinant at a pixel is that of det(H) / w^3.
        let at_middle = self.fit.world_from_pixel * Vector3::new(middle_px[0], middle_px[1], 1.0);
        if self.fit.world_from_pixel.determinant() * at_middle.z >= 0.0 {
            return Err(
                "the points make the picture a mirror image of the table, which no camera above it sees: columns and rows are \
                 swapped, or x and y, or a sign is lost, or the camera mirrors its picture"
                    .to_owned(),
            );
        }
        let shares = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let corners = shares.map(|share| self.corner(settings, pixel_at(window, share)));
        let ([Some(first), Some(second), Some(third), Some(fourth)], Some(middle)) =
            (corners, self.fit.world_from_pixel(middle_px))
        else {
            return Err(
                "by the points, a part of the window shows no table but what lies beyond its horizon: their pixels or places \
                 are wrong"
                    .to_owned(),
            );
        };
        let corners = [first, second, third, fourth];
        let center = Point3::from(settings.table.center_m);
        let middle_mm = (middle - center).xy().norm() * 1000.0;
        if middle_mm > MAX_MIDDLE_MM {
            return Err(format!(
                "by the points the window's middle shows {:.3}, {:.3}, {middle_mm:.0} mm from `table.center_m`; at most \
                 {MAX_MIDDLE_MM} mm are accepted: move the window, or the points are in another frame than the arm's base, \
                 or their pixels are of another picture",
                middle.x, middle.y
            ));
        }
        let limit_mm = self.terms.limit_mm;
        for Corner {
            at_m: [x, y, z],
            error_mm,
        } in corners
        {
            let off_mm = (z - center.z).abs() * 1000.0;
            if off_mm > MAX_HEIGHT_MM {
                return Err(format!(
                    "at {x:.3}, {y:.3} the points put the table at {z:.4} m, {off_mm:.1} mm from the height in \
                     `table.center_m`; at most {MAX_HEIGHT_MM} mm are accepted: level the table, and touch each point with \
                     the fingertips on it"
                ));
            }
            if error_mm > limit_mm {
                return Err(format!(
                    "at the corner {x:.3}, {y:.3} the points know the table to {error_mm:.1} mm; at most {limit_mm} mm are \
                     accepted: touch a grid of 4 x 4 over all that tasks see"
                ));
            }
        }
        Ok(corners)
    }

    /// Returns the place that a pixel shows, drawn in to what the arm reaches; `None` beyond the horizon.
    fn corner(&self, settings: &Settings, pixel: [f64; 2]) -> Option<Corner> {
        let shown = self.fit.world_from_pixel(pixel)?;
        let (least, most) = (settings.workspace.min_m, settings.workspace.max_m);
        let [x, y] = [0, 1].map(|axis| shown[axis].max(least[axis]).min(most[axis]));
        let at = Point3::new(x, y, self.table_height_m([x, y]));
        let pixel = self.fit.pixel_from_world(at)?;
        let off_mm = |other: &Plane| Some((other.world_from_pixel(pixel)? - at).norm() * 1000.0);
        let off_mm: Option<Vec<f64>> = self.others.iter().map(off_mm).collect();
        let scale = (self.others.len() as f64 - 1.0).sqrt();
        Some(Corner {
            at_m: at.into(),
            error_mm: scale * root_mean_square(off_mm?.into_iter()),
        })
    }
}

/// Returns how many different places of the picture points show.
fn count_places(pairs: &[Pair]) -> usize {
    let mut places: Vec<[f64; 2]> = Vec::new();
    for Pair { pixel: [u, v], .. } in pairs {
        if !places
            .iter()
            .any(|place| (place[0] - u).hypot(place[1] - v) < SAME_PX)
        {
            places.push([*u, *v]);
        }
    }
    places.len()
}

fn root_mean_square(errors: impl Iterator<Item = f64>) -> f64 {
    let squares: Vec<f64> = errors.map(|error| error * error).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}
