//! Camera calibration: maps pixels to the arm's base frame, from points that the arm touched and the camera saw.
//!
//! In: [`Pair`]s of a pixel and a tool position, and the [`Terms`] under which they were measured. Out: a
//! [`Calibration`] with the error of each point, or why the points are refused. Against an arm's settings it says how
//! well the table's corners are known (`accuracy`). A calibration is a text file with a picture beside it (`file`),
//! detects that its camera was moved (`moved`), and provides the camera model of the square picture that tasks see
//! (`view`). Nothing here talks to a person or reads a clock; the arm is only read, at a point to which a person guided
//! it (`touch`).

mod accuracy;
mod file;
mod fit;
mod moved;
mod points;
#[cfg(test)]
mod tests;
mod touch;
mod view;

pub use accuracy::Corner;
pub use points::{MAX_PAIRS, SeenTags, csv_line, parse_pairs, parse_pixel, read_pairs};
pub use touch::place_at_rest;
pub use view::check_window;

use super::rgbd::Intrinsics;
use fab_picture::camera::{Lens, Plane};
use image::GrayImage;
use serde::{Deserialize, Serialize};

/// The default limit on the error of a point that the others predict, root mean square, millimetres: the driver counts
/// a pose as reached within 3 mm, and a worse calibration would dominate where a pick lands.
pub const LIMIT_MM: f64 = 4.0;

/// The largest limit that may be requested, millimetres: beyond it a fold's corner is missed.
const MAX_LIMIT_MM: f64 = 20.0;

/// Why points have no fit.
const UNDETERMINED: &str = "the points lie on a line, or all but one do, and determine no fit: spread them over the table, \
     as a grid of 4 x 4";

/// A point that the camera saw and the fingertips touched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// Its position in the camera's own picture, `[column, row]`; the middle of the pixel in column 3 is at 3.5.
    pub pixel: [f64; 2],
    /// Position of the tool when the fingertips touch the point, metres, base frame.
    pub base_m: [f64; 3],
}

/// The camera that saw the points, and how well they must agree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Terms {
    /// The largest error of a point that the others predict, root mean square, millimetres.
    pub limit_mm: f64,
    /// Width and height of the camera's own picture, pixels.
    pub size_px: [u32; 2],
    /// The camera's projection, if it is known; its distortion is taken out of the pixels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<Intrinsics>,
}

impl Terms {
    /// Returns the camera's lens, if its projection is known; fails if no points could meet the terms.
    pub fn lens(&self) -> Result<Option<Lens>, String> {
        let limit_mm = self.limit_mm;
        if !(limit_mm > 0.0 && limit_mm <= MAX_LIMIT_MM) {
            return Err(format!(
                "the limit is {limit_mm} mm; it must be larger than 0 and at most {MAX_LIMIT_MM}; the default is {LIMIT_MM}"
            ));
        }
        let Some(intrinsics) = &self.intrinsics else {
            return Ok(None);
        };
        let ([width, height], [stated_width, stated_height]) = (self.size_px, intrinsics.size_px);
        if intrinsics.size_px != self.size_px {
            return Err(format!(
                "the camera's intrinsics are for a picture of {stated_width} x {stated_height} px, and the picture has {width} x {height} px"
            ));
        }
        let given = &intrinsics.distortion;
        if !matches!(given.len(), 0 | 4 | 5) {
            return Err(format!(
                "`distortion` has {} coefficients; `plumb_bob` has 4 or 5, and none is right too",
                given.len()
            ));
        }
        let mut distortion = [0.0; 5];
        distortion[..given.len()].copy_from_slice(given);
        Ok(Some(Lens {
            focal_px: intrinsics.focal_px,
            middle_px: intrinsics.middle_px,
            distortion,
        }))
    }

    /// Fits the map from pixels to the table to points, without judging it; fails if they determine none.
    pub fn fit(&self, pairs: &[Pair]) -> Result<Plane, String> {
        let lens = self.lens()?;
        let points = self.straightened(lens.as_ref(), pairs)?;
        fit::fit(lens.as_ref(), &points).ok_or_else(|| UNDETERMINED.to_owned())
    }

    /// Returns how far a point is from where others put it, millimetres; `None` if they do not determine that.
    pub fn off_mm(&self, others: &[Pair], pair: &Pair) -> Option<f64> {
        let fit = self.fit(others).ok()?;
        let point = self.straightened(fit.lens.as_ref(), &[*pair]).ok()?;
        Some(fit::error_mm(&fit, &point[0]))
    }
}

/// A calibrated camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The camera, and how well the points had to agree.
    pub terms: Terms,
    /// The date on which it was made, UTC, e.g. `2026-11-22`.
    pub made_on: String,
    /// The points it was made from.
    pub pairs: Vec<Pair>,
    /// The map from pixels to the table in the base frame.
    pub fit: Plane,
    /// For each point, the map by the others.
    others: Vec<Plane>,
    /// For each point, its distance in space from where the others put it, millimetres.
    pub left_out_mm: Vec<f64>,
    /// The camera's picture at that time, for detecting a moved camera.
    pub reference: Option<GrayImage>,
}
