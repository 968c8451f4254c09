//! Camera calibration: maps pixels to the arm's base frame, from points that the arm touched and the camera saw.
//!
//! In: [`Pair`]s of a pixel and a tool position, and the [`Terms`] under which they were measured. Out: a
//! [`Calibration`], with the error of each point; or a [`Refusal`]. Against an arm's settings it says how well the
//! table's corners are known (`accuracy`). A calibration is a text file with a picture beside it (`file`), detects that
//! its camera was moved (`moved`), and provides the camera model of the square picture that tasks see (`view`).
//! Nothing here talks to a person or reads a clock; the arm is only read, at a point to which a person guided it
//! (`touch`).

mod accuracy;
mod file;
mod fit;
mod moved;
mod points;
#[cfg(test)]
mod tests;
mod touch;
mod view;

pub use accuracy::{Accuracy, Corner, Refusal};
pub use points::{MAX_PAIRS, SeenTags, ToolReader, csv_line, parse_pairs, read_pairs, typed_pair};
pub use touch::place_at_rest;
pub use view::Window;

use super::rgbd::Intrinsics;
use super::settings::{CameraSettings, CameraSource, Settings};
use fab_picture::camera::Plane;
use image::GrayImage;
use serde::{Deserialize, Serialize};

/// The fewest distinct points accepted.
///
/// Four points fit a homography exactly, whatever was typed; only with twice as many is leaving one out informative.
pub const MIN_PAIRS: usize = 8;

/// The default limit on the error of a point that the others predict, root mean square, millimetres: the driver counts
/// a pose as reached within 3 mm, and a worse calibration would dominate where a pick lands.
pub const LIMIT_MM: f64 = 4.0;

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
    /// The camera's name, for people.
    pub camera: String,
    /// Width and height of the camera's own picture, pixels.
    pub size_px: [u32; 2],
    /// The camera's projection, if it is known; its distortion is taken out of the pixels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intrinsics: Option<Intrinsics>,
}

impl Terms {
    /// Returns the terms for the camera of an arm's settings.
    ///
    /// - `size_px`: size of the camera's own picture.
    pub fn of(settings: &Settings, size_px: [u32; 2], limit_mm: f64) -> Terms {
        Terms {
            limit_mm,
            camera: camera_name(settings),
            size_px,
            intrinsics: settings.camera.intrinsics.clone(),
        }
    }

    /// Fails if no points could meet them; asked before anybody touches points in vain.
    pub fn check(&self) -> Result<(), Refusal> {
        accuracy::check_terms(self)?;
        Ok(())
    }

    /// The fewest points whose fit can predict another one.
    pub const MIN_PREDICTING: usize = 5;

    /// Returns how far a point is from where others put it, millimetres; `None` if they do not determine that.
    pub fn off_mm(&self, others: &[Pair], pair: &Pair) -> Option<f64> {
        let lens = accuracy::check_terms(self).ok()?;
        let lens = lens.as_ref();
        let fit = fit::fit(lens, &fit::sightings(lens, others).ok()?)?;
        let point = *fit::sightings(lens, &[*pair]).ok()?.first()?;
        Some(fit::error(&fit, &point)?.norm() * 1000.0)
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
    /// The errors of the points.
    pub accuracy: Accuracy,
    /// The camera's picture at that time, for detecting a moved camera.
    pub reference: Option<GrayImage>,
}

impl Calibration {
    /// Fits the map from pixels to the base frame to points; fails if they are wrong, too few or disagree.
    ///
    /// - `made_on`: the date, UTC, e.g. `2026-11-22`.
    /// - `reference`: the camera's picture of the table, in the size stated by the terms.
    pub fn make(
        terms: Terms,
        pairs: Vec<Pair>,
        made_on: &str,
        reference: Option<GrayImage>,
    ) -> Result<Calibration, Refusal> {
        let accuracy::Fitted {
            fit,
            others,
            accuracy,
        } = accuracy::fitted(&terms, &pairs)?;
        if let Some(picture) = &reference
            && [picture.width(), picture.height()] != terms.size_px
        {
            let ((width, height), [right_width, right_height]) =
                (picture.dimensions(), terms.size_px);
            return Err(Refusal::from(format!(
                "the picture has {width} x {height} px, and the camera's pictures {right_width} x {right_height} px"
            )));
        }
        Ok(Calibration {
            terms,
            made_on: made_on.to_owned(),
            pairs,
            fit,
            others,
            accuracy,
            reference,
        })
    }
}

/// Returns the name of the settings' camera: its topic, its folder, or that it is simulated.
fn camera_name(settings: &Settings) -> String {
    let CameraSettings { source, folder, .. } = &settings.camera;
    let name = match source {
        CameraSource::Ros => settings.ros.as_ref().and_then(|ros| ros.color.clone()),
        CameraSource::Ros2 => settings.ros2.as_ref().and_then(|ros2| ros2.color.clone()),
        CameraSource::Directory => folder.as_ref().map(|it| it.display().to_string()),
        CameraSource::Simulated => Some("simulated".to_owned()),
    };
    name.unwrap_or_else(|| "camera".to_owned())
}
