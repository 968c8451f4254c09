//! The faults of calibration points: one sentence each, with what would be right.
//!
//! In: the findings of the checks. Out: why points are refused, one fault per line, and the fit that they refer to.
//! Points are numbered from 1, in input order.

use super::{Check, LIMIT_MM, MIN_PAIRS};
use fab_picture::camera::Plane;

/// The largest limit that may be requested, millimetres: beyond it a fold's corner is missed.
pub(super) const MAX_LIMIT_MM: f64 = 20.0;

/// A fault in points, or in what is stated of their camera.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A number that is not finite.
    #[error("point {point} has a number that is not finite")]
    NotFinite {
        /// Its number.
        point: usize,
    },
    /// The window does not lie in the picture.
    #[error(
        "the window `{left}, {top}, {side}` does not lie in the camera's picture of {} x {} px; its left and its side \
         come to {} at the most, its top and its side to {}", size_px[0], size_px[1], size_px[0], size_px[1]
    )]
    Window {
        /// Its left, pixels.
        left: u32,
        /// Its top, pixels.
        top: u32,
        /// Its side, pixels.
        side: u32,
        /// Width and height of the picture.
        size_px: [u32; 2],
    },
    /// A pixel outside the picture.
    #[error(
        "point {point} is at the pixel {:.1}, {:.1}, outside of the picture of {} x {} px",
        pixel[0], pixel[1], size_px[0], size_px[1]
    )]
    OutsidePicture {
        /// Its number.
        point: usize,
        /// Its pixel.
        pixel: [f64; 2],
        /// Width and height of the picture.
        size_px: [u32; 2],
    },
    /// A position that no arm reaches.
    #[error("point {point} is at {}, {}, {}; an arm reaches about a metre, and positions are metres", base[0], base[1], base[2])]
    TooFar {
        /// Its number.
        point: usize,
        /// Its position as given.
        base: [f64; 3],
    },
    /// Too few points.
    #[error(
        "{n} distinct points are too few: at least {MIN_PAIRS} are needed, because any four points fit exactly; \
         touch a grid of 4 x 4 over the table"
    )]
    TooFew {
        /// How many there are.
        n: usize,
    },
    /// Something that a calibration is compared with is unknown.
    #[error(
        "{} not stated in the settings, so that a wrong calibration could not be noticed: see `Calibration` in docs/arm.md{}",
        are(.keys), if keys.contains(&"camera.intrinsics") { "; `--shoot` asks a camera that reports its intrinsics" } else { "" }
    )]
    NotStated {
        /// Their keys.
        keys: Vec<&'static str>,
    },
    /// Impossible intrinsics.
    #[error("the camera's intrinsics cannot be used: {why}")]
    Intrinsics {
        /// What is wrong.
        why: String,
    },
    /// Intrinsics for pictures of another size.
    #[error("the camera's intrinsics are for a picture of {} x {} px, and the picture has {} x {} px", stated[0], stated[1], size_px[0], size_px[1])]
    IntrinsicsSize {
        /// The size that the intrinsics state.
        stated: [u32; 2],
        /// The size of the picture.
        size_px: [u32; 2],
    },
    /// The settings state another camera than the calibrated one.
    #[error(
        "the settings state another camera than the calibrated one: {what}; calibrate anew, or state the camera as it was"
    )]
    OtherCamera {
        /// What is different.
        what: String,
    },
    /// No ray leads to a pixel through the lens.
    #[error(
        "no ray leads through the lens to point {point}: the coefficients in `distortion` do not reach that far"
    )]
    NoRay {
        /// Its number.
        point: usize,
    },
    /// A picture of the wrong size.
    #[error("the picture has {} x {} px, and the camera's pictures {} x {} px", found[0], found[1], expected[0], expected[1])]
    PictureSize {
        /// Its size.
        found: [u32; 2],
        /// The expected size.
        expected: [u32; 2],
    },
    /// Points that do not determine a fit.
    #[error(
        "the points lie on a line, or all but one do, and determine no fit: spread them over the table, as a grid of 4 x 4"
    )]
    Undetermined,
    /// The fit depends on a single point.
    #[error(
        "without point {point} the others do not determine a fit: touch more points, away from their line"
    )]
    HangsOn {
        /// Its number.
        point: usize,
    },
    /// A part of the window does not show the table.
    #[error(
        "by the points, a part of the window shows no table but what lies beyond its horizon: their pixels or places are wrong"
    )]
    Horizon,
    /// A mirror image.
    #[error(
        "the points make the picture a mirror image of the table, which no camera above it sees: columns and rows are \
         swapped, or x and y, or a sign is lost, or the camera mirrors its picture"
    )]
    Mirrored,
    /// A point that contradicts the others.
    #[error(
        "point {point} is {off_mm:.1} mm off: the other points put its pixel at {:.4}, {:.4}, {:.4}, but it \
         was given as {:.4}, {:.4}, {:.4}", shown_m[0], shown_m[1], shown_m[2], base_m[0], base_m[1], base_m[2]
    )]
    Outlier {
        /// Its number.
        point: usize,
        /// Its error, millimetres.
        off_mm: f64,
        /// The position of its pixel according to the others, metres, base frame.
        shown_m: [f64; 3],
        /// Its stated position.
        base_m: [f64; 3],
    },
    /// A value beyond its bound.
    #[error("{}; at most {} {}: {}", .0.text, rounded(.0.bound), unit(.0.name), .0.next)]
    Beyond(Check),
    /// An invalid limit.
    #[error(
        "the limit is {limit_mm} mm; it must be larger than 0 and at most {MAX_LIMIT_MM}; the default is {LIMIT_MM}"
    )]
    Limit {
        /// The limit as given.
        limit_mm: f64,
    },
}

/// Lists keys as the subject of a sentence, with its verb.
fn are(keys: &[&str]) -> String {
    let listed = format!("`{}`", keys.join("`, `"));
    let verb = if keys.len() == 1 { "is" } else { "are" };
    format!("{listed} {verb}")
}

fn rounded(bound: f64) -> f64 {
    (bound * 10.0).round() / 10.0
}

/// Returns the unit at the end of a value's name, and that it is accepted.
fn unit(name: &str) -> &'static str {
    match name.rsplit('_').next() {
        Some("mm" | "gain") => "mm are accepted",
        Some("deg") => "degrees are accepted",
        _ => "% are accepted",
    }
}

/// Why points were refused.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// What is wrong; at least one.
    pub faults: Vec<Fault>,
    /// The fit of the points that agree, if there is one, as a reference for the others.
    pub fit: Option<Box<Plane>>,
}

impl std::error::Error for Refusal {}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let faults: Vec<String> = self.faults.iter().map(Fault::to_string).collect();
        f.write_str(&faults.join("\n"))
    }
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Refusal {
        Refusal {
            faults: vec![fault],
            fit: None,
        }
    }
}
