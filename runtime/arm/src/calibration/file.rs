//! A calibration as text, with the camera's picture beside it.
//!
//! In: a calibration or a file. Out: the other. Everything read is checked: each number, the picture's hash, and the
//! fit, which is recomputed from the points. An edited or truncated file is refused.

use super::accuracy::Accuracy;
use super::fit::Fit;
use super::{Calibration, Method, Pair, Terms, Window};
use crate::rgbd::Intrinsics;
use fab_base::{digest, files};
use fab_picture::png;
use image::GrayImage;
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Version of the file format.
const FORMAT: u32 = 1;
/// The longest file accepted.
pub(super) const MAX_BYTES: u64 = 1 << 20;
/// How far stored results may differ from recomputed ones, millimetres: far above rounding errors, far below any
/// effect.
const SAME_MM: f64 = 0.01;

/// Why a calibration cannot be read or written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{file}` {why}")]
pub struct FileError {
    /// The file.
    pub file: String,
    /// What is wrong.
    pub why: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    format: u32,
    method: String,
    made_on: String,
    limit_mm: f64,
    reference_sha256: Option<String>,
    camera: StoredCamera,
    fit: StoredFit,
    points: Vec<StoredPoint>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredCamera {
    name: String,
    size_px: [u32; 2],
    window_px: [u32; 3],
    reach_m: [[f64; 2]; 2],
    intrinsics: Option<Intrinsics>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredFit {
    matrix: Vec<Vec<f64>>,
    height: [f64; 3],
    rms_mm: f64,
    left_out_mm: f64,
    scale: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredPoint {
    pixel: [f64; 2],
    base_m: [f64; 3],
    depth_m: Option<f64>,
    residual_mm: f64,
    left_out_mm: f64,
}

impl Calibration {
    /// Returns the path of the camera's picture beside a calibration file, a PNG file.
    pub fn picture_beside(path: &Path) -> PathBuf {
        path.with_extension("png")
    }

    /// Writes it, picture first; replaces existing files.
    ///
    /// A crash between the two leaves a file that [`Calibration::load`] refuses, because it names its picture's hash.
    pub fn save(&self, path: &Path) -> Result<(), FileError> {
        let write = |path: &Path, bytes: &[u8]| {
            files::write_whole(path, bytes).map_err(|error| FileError {
                file: path.display().to_string(),
                why: format!("cannot be written: {error}"),
            })
        };
        if let Some(reference) = &self.reference {
            write(
                &Calibration::picture_beside(path),
                &png::encode_gray(reference),
            )?;
        }
        write(path, self.to_toml().as_bytes())
    }

    /// Reads a file, and its picture if it names one, and checks both.
    pub fn load(path: &Path) -> Result<Calibration, FileError> {
        let wrong = |path: &Path, why: String| FileError {
            file: path.display().to_string(),
            why,
        };
        let unreadable = |why: String| wrong(path, format!("cannot be read: {why}"));
        let text = files::read_text(path, MAX_BYTES).map_err(unreadable)?;
        let unusable = |why: String| wrong(path, format!("is not a usable calibration: {why}"));
        let (mut calibration, hash) = Calibration::parse(&text).map_err(unusable)?;
        if let Some(hash) = hash {
            let beside = Calibration::picture_beside(path);
            let reference = png::load(&beside).map_err(|error| unusable(error.to_string()))?;
            let reference = image::imageops::grayscale(&reference);
            if hash_of(&reference) != hash {
                let why = "is not the picture that the calibration beside it was made with; calibrate anew";
                return Err(wrong(&beside, why.to_owned()));
            }
            calibration.reference = Some(reference);
        }
        Ok(calibration)
    }

    /// Reads a calibration from text and checks it against its own points; also returns the hash of its picture.
    fn parse(text: &str) -> Result<(Calibration, Option<String>), String> {
        let stored: Stored = toml::from_str(text).map_err(|error| error.to_string())?;
        if stored.format != FORMAT {
            let format = stored.format;
            return Err(format!(
                "its format is {format}, and this fabc reads {FORMAT}"
            ));
        }
        if !is_day(&stored.made_on) {
            let day: String = stored.made_on.chars().take(20).collect();
            return Err(format!(
                "`made_on` is `{day}`, which is not a date such as `2026-11-22`"
            ));
        }
        let method = [Method::Plane, Method::Rigid]
            .into_iter()
            .find(|method| method.name() == stored.method)
            .ok_or("`method` is neither `plane` nor `rigid`")?;
        let terms = Terms {
            method,
            camera: stored.camera.name.clone(),
            size_px: stored.camera.size_px,
            intrinsics: stored.camera.intrinsics.clone(),
            window: Window::from(stored.camera.window_px),
            reach_m: stored.camera.reach_m,
            limit_mm: stored.limit_mm,
        };
        let points = stored.points.iter().take(super::MAX_PAIRS + 1);
        let pairs: Vec<Pair> = points
            .map(|point| Pair {
                pixel: point.pixel,
                base_m: point.base_m,
                depth_m: point.depth_m,
            })
            .collect();
        if pairs.len() > super::MAX_PAIRS {
            return Err(format!("it has more than {} points", super::MAX_PAIRS));
        }
        let calibration = Calibration::make(terms, pairs, &stored.made_on, None)
            .map_err(|refusal| format!("its points are refused: {refusal}"))?;
        match difference(&stored, &calibration) {
            Some(what) => Err(format!(
                "{what} does not fit its points: it was edited or damaged; calibrate anew, or give its points to `fabc calibrate`"
            )),
            None => Ok((calibration, stored.reference_sha256)),
        }
    }

    /// Returns it as text.
    pub fn to_toml(&self) -> String {
        let Terms {
            method,
            camera,
            size_px,
            intrinsics,
            window,
            reach_m,
            limit_mm,
        } = &self.terms;
        let mut text = format!(
            "# Written by `fabc calibrate`. Its numbers are checked against its points when it is read: do not edit it.\n\
             format = {FORMAT}\nmethod = \"{}\"\nmade_on = {}\nlimit_mm = {limit_mm:?}\n",
            method.name(),
            quoted(&self.made_on)
        );
        if let Some(reference) = &self.reference {
            let _ = writeln!(text, "reference_sha256 = \"{}\"", hash_of(reference));
        }
        let window = [window.left_px, window.top_px, window.side_px];
        let _ = write!(
            text,
            "\n[camera]\nname = {}\nsize_px = {size_px:?}\nwindow_px = {window:?}\nreach_m = {reach_m:?}\n",
            quoted(camera)
        );
        if let Some(Intrinsics {
            size_px,
            focal_px,
            middle_px,
            distortion,
        }) = intrinsics
        {
            let _ = write!(
                text,
                "\n[camera.intrinsics]\nsize_px = {size_px:?}\nfocal_px = {focal_px:?}\nmiddle_px = {middle_px:?}\n\
                 distortion = {distortion:?}\n"
            );
        }
        let Accuracy {
            rms_mm,
            left_out_rms_mm,
            ..
        } = &self.accuracy;
        let what = match self.fit {
            Fit::Plane { .. } => "from (column, row, 1) to the base's (x, y, 1) in metres",
            Fit::Rigid { .. } => "from the camera's frame to the base's, in metres",
        };
        let _ = write!(
            text,
            "\n[fit]\n# {what}; the table's height is a + b x + c y.\nmatrix = [\n"
        );
        for row in matrix(&self.fit) {
            let _ = writeln!(text, "  {row:?},");
        }
        let _ = write!(
            text,
            "]\nheight = {:?}\nrms_mm = {rms_mm:?}\nleft_out_mm = {left_out_rms_mm:?}\n",
            self.fit.height()
        );
        if let Fit::Rigid { scale, .. } = self.fit {
            let _ = writeln!(text, "scale = {scale:?}");
        }
        let errors = self
            .accuracy
            .residual_mm
            .iter()
            .zip(&self.accuracy.left_out_mm);
        for (pair, (residual, left_out)) in self.pairs.iter().zip(errors) {
            let _ = write!(
                text,
                "\n[[points]]\npixel = {:?}\nbase_m = {:?}\n",
                pair.pixel, pair.base_m
            );
            if let Some(depth) = pair.depth_m {
                let _ = writeln!(text, "depth_m = {depth:?}");
            }
            let _ = write!(
                text,
                "residual_mm = {residual:?}\nleft_out_mm = {left_out:?}\n"
            );
        }
        text
    }
}

fn matrix(fit: &Fit) -> Vec<Vec<f64>> {
    match fit {
        Fit::Plane {
            base_from_pixel, ..
        } => rows(base_from_pixel.row_iter()),
        Fit::Rigid {
            base_from_camera, ..
        } => rows(base_from_camera.to_homogeneous().row_iter()),
    }
}

fn rows<'m, R, C, S>(
    rows: impl Iterator<Item = nalgebra::Matrix<f64, R, C, S>> + 'm,
) -> Vec<Vec<f64>>
where
    R: nalgebra::Dim,
    C: nalgebra::Dim,
    S: nalgebra::RawStorage<f64, R, C> + 'm,
{
    rows.map(|row| row.iter().copied().collect()).collect()
}

/// Names the stored number that differs from the recomputed one; `None` if all agree.
fn difference(stored: &Stored, made: &Calibration) -> Option<&'static str> {
    let is_near = |a: f64, b: f64| (a - b).abs() <= SAME_MM;
    let ours = matrix(&made.fit);
    let is_formed = stored.fit.matrix.len() == ours.len()
        && stored.fit.matrix.iter().all(|row| row.len() == ours.len());
    if !is_formed || !shows_the_same(&stored.fit.matrix, stored.fit.height, made) {
        return Some("`fit.matrix` or `fit.height`");
    }
    let accuracy = &made.accuracy;
    if !is_near(stored.fit.rms_mm, accuracy.rms_mm)
        || !is_near(stored.fit.left_out_mm, accuracy.left_out_rms_mm)
    {
        return Some("`fit.rms_mm` or `fit.left_out_mm`");
    }
    let scale = match made.fit {
        Fit::Plane { .. } => None,
        Fit::Rigid { scale, .. } => Some(scale),
    };
    let is_scale = match (stored.fit.scale, scale) {
        (None, None) => true,
        (Some(stored), Some(made)) => (stored - made).abs() < 1e-6,
        _ => false,
    };
    if !is_scale {
        return Some("`fit.scale`");
    }
    let errors = accuracy.residual_mm.iter().zip(&accuracy.left_out_mm);
    let is_same = |(point, (residual, left_out)): (&StoredPoint, (&f64, &f64))| {
        is_near(point.residual_mm, *residual) && is_near(point.left_out_mm, *left_out)
    };
    let are_same = stored.points.iter().zip(errors).all(is_same);
    (!are_same).then_some("`residual_mm` or `left_out_mm` of a point")
}

/// Returns whether a stored fit maps points and the window's corners as the recomputed fit does.
fn shows_the_same(stored: &[Vec<f64>], height: [f64; 3], made: &Calibration) -> bool {
    let number = |row: usize, column: usize| stored[row][column];
    let mut fit = made.fit.clone();
    match &mut fit {
        Fit::Plane {
            base_from_pixel,
            height: of_fit,
            ..
        } => {
            *base_from_pixel = nalgebra::Matrix3::from_fn(number);
            *of_fit = height;
        }
        Fit::Rigid {
            base_from_camera,
            height: of_fit,
            ..
        } => {
            let matrix = nalgebra::Matrix4::from_fn(number);
            // The recomputed pose is used; the stored one only has to agree.
            let off = matrix - base_from_camera.to_homogeneous();
            *of_fit = height;
            if !off.iter().all(|number| number.abs() * 1000.0 <= SAME_MM) {
                return false;
            }
        }
    }
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let corners = corners.map(|share| made.terms.window.pixel_at(share));
    let pixels = made.pairs.iter().map(|pair| pair.pixel).chain(corners);
    pixels.into_iter().all(|pixel| {
        match (
            fit.table_from_pixel(pixel),
            made.fit.table_from_pixel(pixel),
        ) {
            (Some(stored), Some(made)) => (stored - made).norm() * 1000.0 <= SAME_MM,
            (None, None) => true,
            _ => false,
        }
    })
}

/// Returns a TOML string; JSON's escapes are TOML's, except for the delete character.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text)
        .to_string()
        .replace('\u{7f}', "\\u007F")
}

fn hash_of(picture: &GrayImage) -> String {
    let mut hasher = Sha256::new();
    hasher.update(picture.width().to_le_bytes());
    hasher.update(picture.as_raw());
    digest::hex(&hasher.finalize())
}

/// Returns whether a text is a date such as `2026-11-22`.
fn is_day(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let number = |part: &str, length: usize| {
        let is_plain = part.len() == length && part.bytes().all(|byte| byte.is_ascii_digit());
        is_plain.then(|| part.parse::<u32>().ok()).flatten()
    };
    match parts[..] {
        [year, month, day] => {
            number(year, 4).is_some()
                && number(month, 2).is_some_and(|month| (1..=12).contains(&month))
                && number(day, 2).is_some_and(|day| (1..=31).contains(&day))
        }
        _ => false,
    }
}
