//! Camera calibration: maps pixels to the arm's base frame, from points that the arm touched and the camera saw.
//!
//! In: [`Pair`]s of a pixel and a tool position, and the [`Terms`] that they must meet. Out: a [`Calibration`], with
//! the error of each point and how point errors propagate over the table; or a [`Refusal`] that names the mistake. A
//! calibration is a text file with a picture beside it (`file`), detects that its camera was moved (`moved`), and
//! provides the camera model of the square picture that tasks see (`view`). Nothing here talks to a person or reads a
//! clock; the arm is only read, at a point to which a person guided it (`touch`).

mod accuracy;
mod fault;
mod file;
mod fit;
mod judge;
mod mistakes;
mod moved;
mod pairs;
mod plane;
mod refusal;
mod rigid;
mod session;
mod sighting;
mod spread;
#[cfg(test)]
mod tests;
mod touch;
mod view;

pub use accuracy::Accuracy;
pub use fault::Fault;
pub use file::FileError;
pub use fit::Fit;
pub use moved::Moved;
pub use pairs::{MAX_PAIRS, PairError, csv_line, parse_pairs, read_pairs};
pub use refusal::Refusal;
pub use session::{LineOutcome, Session, ToolReader, grid};
pub use spread::Spread;
pub use touch::place_at_rest;
pub use view::Window;

use super::rgbd::Intrinsics;
use super::settings::{CameraSettings, CameraSource, Settings};
use image::GrayImage;

/// The fewest distinct points accepted.
///
/// Four points fit a homography exactly, whatever was typed; only with twice as many is leaving one out informative.
pub const MIN_PAIRS: usize = 8;

/// Factor by which left-out errors may be larger: they measure the uncertainty at places without a touched point.
const LEFT_OUT_SHARE: f64 = 5.0 / 3.0;

/// A point that the camera saw and the fingertips touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Its position in the camera's own picture, `[column, row]`; the middle of the pixel in column 3 is at 3.5.
    pub pixel: [f64; 2],
    /// Position of the tool when the fingertips touch the point, metres, base frame.
    pub base_m: [f64; 3],
    /// Depth that the camera reads there, metres along the optical axis.
    pub depth_m: Option<f64>,
}

/// How pixels are mapped to the base frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// A homography to the table's plane; needs neither depth nor intrinsics, and knows nothing above the table.
    Plane,
    /// A rotation and a translation from the camera to the base; needs depth at every point, and intrinsics.
    Rigid,
}

impl Method {
    /// Returns the default limit on the root mean square error, millimetres.
    ///
    /// By the plane 3: the driver counts a pose as reached within that, and a worse calibration would dominate where a
    /// pick lands. With depth 5: its readings scatter by 2 mm at a metre, and the fit averages that out.
    pub fn limit_mm(self) -> f64 {
        match self {
            Method::Plane => 3.0,
            Method::Rigid => 5.0,
        }
    }

    /// Returns its name in files: `plane` or `rigid`.
    pub fn name(self) -> &'static str {
        match self {
            Method::Plane => "plane",
            Method::Rigid => "rigid",
        }
    }
}

/// The subject of a calibration, and its requirements.
#[derive(Clone, Debug, PartialEq)]
pub struct Terms {
    /// How pixels are mapped to the base frame.
    pub method: Method,
    /// The camera's name, for people.
    pub camera: String,
    /// Width and height of the camera's own picture, pixels.
    pub size_px: [u32; 2],
    /// The camera's projection, if known; its distortion is removed from the pixels.
    pub intrinsics: Option<Intrinsics>,
    /// The part of the picture that tasks see, where the calibration must hold.
    pub window: Window,
    /// The least and the largest x and y of the tool, metres, base frame; elsewhere the calibration need not hold.
    pub reach_m: [[f64; 2]; 2],
    /// The largest root mean square error, millimetres.
    pub limit_mm: f64,
}

impl Terms {
    /// Returns the terms for an arm's settings.
    ///
    /// `size_px` is the size of the camera's own picture, `limit_mm` the largest root mean square error.
    pub fn of(settings: &Settings, method: Method, size_px: [u32; 2], limit_mm: f64) -> Terms {
        let Settings {
            camera,
            ros,
            workspace,
            ..
        } = settings;
        let topic = ros.as_ref().and_then(|ros| ros.color.as_deref());
        let level = |corner: [f64; 3]| [corner[0], corner[1]];
        Terms {
            method,
            camera: camera_name(camera, topic),
            size_px,
            intrinsics: camera.intrinsics.clone(),
            window: Window::from(camera.window_px),
            reach_m: [level(workspace.min_m), level(workspace.max_m)],
            limit_mm,
        }
    }
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
    /// The map from pixels to the base frame.
    pub fit: Fit,
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

    /// Fails if the current settings require more than it was made for.
    pub fn check_settings(&self, settings: &Settings) -> Result<(), Refusal> {
        let Terms {
            method,
            size_px,
            limit_mm,
            ..
        } = self.terms;
        let mut terms = Terms::of(settings, method, size_px, limit_mm);
        terms.intrinsics.clone_from(&self.terms.intrinsics);
        judge::judge(&terms, &self.pairs).map(|_| ())
    }
}

/// Returns the name of a camera: its topic, its folder, or that it is simulated.
fn camera_name(camera: &CameraSettings, topic: Option<&str>) -> String {
    let folder = || camera.folder.as_ref().map(|it| it.display().to_string());
    let name = match camera.source {
        CameraSource::Ros => topic.map(str::to_owned),
        CameraSource::Directory => folder(),
        CameraSource::Simulated => Some("simulated".to_owned()),
    };
    name.unwrap_or_else(|| "camera".to_owned())
}
