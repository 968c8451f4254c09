//! Camera calibration: maps pixels to the arm's base frame, from points that the arm touched and the camera saw.
//!
//! In: [`Pair`]s of a pixel and a tool position, and the [`Terms`] that they must meet: limits, and what the settings
//! state of table and camera. Out: a [`Calibration`], with the error of each point and each measured value beside its
//! bound ([`Check`]); or a [`Refusal`]. A calibration is a text file with a picture beside it (`file`), detects that
//! its camera was moved (`moved`), and provides the camera model of the square picture that tasks see (`view`).
//! Nothing here talks to a person or reads a clock; the arm is only read, at a point to which a person guided it
//! (`touch`).

mod accuracy;
mod fault;
mod file;
mod fit;
mod implied;
mod judge;
mod moved;
mod pairs;
mod plane;
mod session;
mod tags;
#[cfg(test)]
mod tests;
mod touch;
mod view;

pub use accuracy::{Accuracy, Check, Corner, Spread};
pub use fault::{Fault, Refusal};
pub use file::FileError;
pub use fit::tilt_deg;
pub use moved::Moved;
pub use pairs::{MAX_PAIRS, PairError, csv_line, parse_pairs, read_pairs};
pub use session::{LineOutcome, Session, ToolReader, grid};
pub use tags::{SeenTags, TagName};
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

/// The default limit on the root mean square error, millimetres: the driver counts a pose as reached within that, and a
/// worse calibration would dominate where a pick lands.
pub const LIMIT_MM: f64 = 3.0;

/// How pixels are mapped, in files and reports: a homography to the table's plane, and a plane through the heights.
pub const METHOD: &str = "plane";

/// A point that the camera saw and the fingertips touched.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// Its position in the camera's own picture, `[column, row]`; the middle of the pixel in column 3 is at 3.5.
    pub pixel: [f64; 2],
    /// Position of the tool when the fingertips touch the point, metres, base frame.
    pub base_m: [f64; 3],
    /// The printed tag in which the pixel was found, if it was not given as numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tag: Option<TagName>,
}

/// What a calibration must fit: limits, and what is stated of the table and the camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Terms {
    /// The largest root mean square error, millimetres.
    pub limit_mm: f64,
    /// The camera's name, for people.
    pub camera: String,
    /// Width and height of the camera's own picture, pixels.
    pub size_px: [u32; 2],
    /// The part of the picture that tasks see, where the calibration must hold; its middle shows the table's.
    pub window: Window,
    /// Height of the lens above the table, metres; `None` is refused.
    pub height_m: Option<f64>,
    /// Direction on the table of the picture's top, degrees about z from the base's x axis; `None` is refused.
    pub up_deg: Option<f64>,
    /// The table's middle as the tool touches it, metres, base frame.
    pub center_m: [f64; 3],
    /// The least and the largest x and y of the tool, metres, base frame; elsewhere the calibration need not hold.
    pub reach_m: [[f64; 2]; 2],
    /// The camera's projection; `None` is refused.
    pub intrinsics: Option<Intrinsics>,
}

impl Terms {
    /// Returns the terms for an arm's settings.
    ///
    /// - `size_px`: size of the camera's own picture.
    /// - `limit_mm`: the largest root mean square error.
    pub fn of(settings: &Settings, size_px: [u32; 2], limit_mm: f64) -> Terms {
        let Settings {
            camera,
            ros,
            ros2,
            workspace,
            table,
            simulated,
            ..
        } = settings;
        let topic = match camera.source {
            CameraSource::Ros2 => ros2.as_ref().and_then(|ros2| ros2.color.as_deref()),
            _ => ros.as_ref().and_then(|ros| ros.color.as_deref()),
        };
        let level = |corner: [f64; 3]| [corner[0], corner[1]];
        let is_simulated = camera.source == CameraSource::Simulated;
        // A simulated picture has the world's y axis up.
        let simulated_up_deg = 90.0 + simulated.camera_turn_deg + table.turn_deg;
        let or_simulated = |stated: Option<f64>, simulated: f64| {
            stated.or_else(|| is_simulated.then_some(simulated))
        };
        Terms {
            limit_mm,
            camera: camera_name(camera, topic),
            size_px,
            window: Window::from(camera.window_px),
            height_m: or_simulated(camera.height_m, simulated.camera_height_m),
            up_deg: or_simulated(camera.up_deg, simulated_up_deg),
            center_m: table.center_m,
            reach_m: [level(workspace.min_m), level(workspace.max_m)],
            intrinsics: stated_intrinsics(settings),
        }
    }

    /// Fails if no points could meet them: the window lies outside the picture, or something is not stated.
    pub fn check(&self) -> Result<(), Fault> {
        judge::check_terms(self).map(|_| ())
    }
}

/// Returns the camera's projection as far as the settings state it.
fn stated_intrinsics(settings: &Settings) -> Option<Intrinsics> {
    let camera = &settings.camera;
    let is_simulated = camera.source == CameraSource::Simulated;
    let stated = camera.intrinsics.clone();
    stated.or_else(|| is_simulated.then(|| settings.simulated.intrinsics()))
}

/// A calibrated camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Its subject, and the requirements it met.
    pub terms: Terms,
    /// The date on which it was made, UTC, e.g. `2026-11-22`.
    pub made_on: String,
    /// The points it was made from.
    pub pairs: Vec<Pair>,
    /// The map from pixels to the table in the base frame.
    pub fit: Plane,
    /// The accuracy of the fit.
    pub accuracy: Accuracy,
    /// The camera's picture at that time, for detecting a moved camera.
    pub reference: Option<GrayImage>,
}

impl Calibration {
    /// Fits the map from pixels to the base frame to points; fails with their faults.
    ///
    /// - `made_on`: the date, UTC, e.g. `2026-11-22`.
    /// - `reference`: the camera's picture of the table, in the size stated by the terms.
    pub fn make(
        terms: Terms,
        pairs: Vec<Pair>,
        made_on: &str,
        reference: Option<GrayImage>,
    ) -> Result<Calibration, Refusal> {
        let (fit, accuracy) = judge::judge(&terms, &pairs)?;
        if let Some(picture) = &reference {
            let found = [picture.width(), picture.height()];
            if found != terms.size_px {
                let expected = terms.size_px;
                return Err(Fault::PictureSize { found, expected }.into());
            }
        }
        Ok(Calibration {
            terms,
            made_on: made_on.to_owned(),
            pairs,
            fit,
            accuracy,
            reference,
        })
    }

    /// Judges it by what the settings state now; fails if they disagree, or require more than it was made for.
    pub fn check_settings(&self, settings: &Settings) -> Result<Accuracy, Refusal> {
        let mut terms = Terms::of(settings, self.terms.size_px, self.terms.limit_mm);
        if let (Some(made_with), Some(stated)) = (&self.terms.intrinsics, &terms.intrinsics)
            && let Some(what) = moved::change(made_with, stated)
        {
            return Err(Fault::OtherCamera { what }.into());
        }
        terms.intrinsics = terms.intrinsics.or_else(|| self.terms.intrinsics.clone());
        judge::judge(&terms, &self.pairs).map(|(_, accuracy)| accuracy)
    }
}

/// Returns the name of a camera: its topic, its folder, or that it is simulated.
fn camera_name(camera: &CameraSettings, topic: Option<&str>) -> String {
    let folder = || camera.folder.as_ref().map(|it| it.display().to_string());
    let name = match camera.source {
        CameraSource::Ros | CameraSource::Ros2 => topic.map(str::to_owned),
        CameraSource::Directory => folder(),
        CameraSource::Simulated => Some("simulated".to_owned()),
    };
    name.unwrap_or_else(|| "camera".to_owned())
}
