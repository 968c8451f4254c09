//! A calibration as text, with the camera's picture beside it.
//!
//! In: a calibration or a file. Out: the other. Everything is computed anew from the points that a file holds, and
//! written again: whatever differs in the file was edited or damaged, and the file is refused.

use super::{Accuracy, Calibration, METHOD, Pair, Spread, Terms};
use fab_base::{digest, files};
use fab_picture::camera::Plane;
use fab_picture::png;
use image::GrayImage;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::Value;
use toml::value::Datetime;

/// Version of the file format.
const FORMAT: i64 = 2;
/// The longest file accepted.
pub(super) const MAX_BYTES: u64 = 1 << 20;
/// How far stored numbers may differ from recomputed ones, as a share: far above rounding errors, far below any effect.
const SAME_SHARE: f64 = 1e-6;
/// The same for numbers near 0.
const SAME: f64 = 1e-9;

const HEADER: &str = "# Written by `fabc calibrate`. Its numbers are checked against its points when it is read: do not edit it.\n";

/// Why a calibration cannot be read or written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{file}` {why}")]
pub struct FileError {
    /// The file.
    pub file: String,
    /// What is wrong.
    pub why: String,
}

/// A file's content, in its order.
#[derive(Serialize, Deserialize)]
struct Stored {
    format: i64,
    method: String,
    made_on: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference_sha256: Option<String>,
    terms: Terms,
    fit: StoredFit,
    accuracy: StoredAccuracy,
    points: Vec<StoredPoint>,
}

#[derive(Serialize, Deserialize)]
struct StoredFit {
    /// From `(column, row, 1)` to the base's `(x, y, 1)` in metres.
    base_from_pixel: [[f64; 3]; 3],
    /// The table's height is `a + b x + c y`.
    height: [f64; 3],
}

#[derive(Serialize, Deserialize)]
struct StoredAccuracy {
    /// Every value that has a bound, by its name.
    #[serde(flatten)]
    checks: BTreeMap<String, f64>,
    spread: Spread,
}

#[derive(Serialize, Deserialize)]
struct StoredPoint {
    #[serde(flatten)]
    pair: Pair,
    residual_mm: f64,
    left_out_mm: f64,
}

impl Stored {
    fn of(calibration: &Calibration, reference_sha256: Option<String>) -> Stored {
        let Calibration {
            terms,
            made_on,
            pairs,
            fit,
            accuracy,
            ..
        } = calibration;
        let Plane {
            world_from_pixel: matrix,
            height,
            ..
        } = fit;
        let Accuracy {
            residual_mm,
            left_out_mm,
            spread,
            checks,
            ..
        } = accuracy;
        let errors = residual_mm.iter().zip(left_out_mm);
        Stored {
            format: FORMAT,
            method: METHOD.to_owned(),
            made_on: made_on.clone(),
            reference_sha256,
            terms: terms.clone(),
            fit: StoredFit {
                base_from_pixel: [0, 1, 2].map(|row| [0, 1, 2].map(|column| matrix[(row, column)])),
                height: *height,
            },
            accuracy: StoredAccuracy {
                checks: checks
                    .iter()
                    .map(|check| (check.name.to_owned(), check.value))
                    .collect(),
                spread: *spread,
            },
            points: pairs
                .iter()
                .zip(errors)
                .map(|(pair, (residual_mm, left_out_mm))| StoredPoint {
                    pair: *pair,
                    residual_mm: *residual_mm,
                    left_out_mm: *left_out_mm,
                })
                .collect(),
        }
    }
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
            files::write_whole(path, bytes)
                .map_err(|error| refused(path, format!("cannot be written: {error}")))
        };
        if let Some(reference) = &self.reference {
            write(&Calibration::picture_beside(path), &png::encode(reference))?;
        }
        write(path, self.to_toml().as_bytes())
    }

    /// Reads a file, and its picture if it names one, and checks both.
    pub fn load(path: &Path) -> Result<Calibration, FileError> {
        let unreadable = |why: String| refused(path, format!("cannot be read: {why}"));
        let text = files::read_text(path, MAX_BYTES).map_err(unreadable)?;
        let unusable = |why: String| refused(path, format!("is not a usable calibration: {why}"));
        let (mut calibration, hash) = Calibration::parse(&text).map_err(unusable)?;
        if let Some(hash) = hash {
            let beside = Calibration::picture_beside(path);
            let reference = png::load(&beside).map_err(|error| unusable(error.to_string()))?;
            let reference = image::imageops::grayscale(&reference);
            if hash_of(&reference) != hash {
                let why = "is not the picture that the calibration beside it was made with; calibrate anew";
                return Err(refused(&beside, why.to_owned()));
            }
            calibration.reference = Some(reference);
        }
        Ok(calibration)
    }

    /// Reads a calibration from text and checks it against its own points; also returns the hash of its picture.
    fn parse(text: &str) -> Result<(Calibration, Option<String>), String> {
        let value: Value = toml::from_str(text).map_err(|error| error.to_string())?;
        let format = value.get("format").and_then(Value::as_integer);
        if let Some(format) = format.filter(|format| *format != FORMAT) {
            return Err(format!(
                "its format is {format}, and this fabc reads {FORMAT}; calibrate anew"
            ));
        }
        let stored: Stored = value
            .clone()
            .try_into()
            .map_err(|error: toml::de::Error| error.to_string())?;
        if !is_day(&stored.made_on) {
            let day: String = stored.made_on.chars().take(20).collect();
            return Err(format!(
                "`made_on` is `{day}`, which is not a date such as `2026-11-22`"
            ));
        }
        if stored.points.len() > super::MAX_PAIRS {
            return Err(format!("it has more than {} points", super::MAX_PAIRS));
        }
        let pairs = stored.points.iter().map(|point| point.pair).collect();
        let calibration = Calibration::make(stored.terms, pairs, &stored.made_on, None)
            .map_err(|refusal| format!("its points are refused: {refusal}"))?;
        let hash = stored.reference_sha256;
        let again = Value::try_from(Stored::of(&calibration, hash.clone()));
        match difference(&value, &again.map_err(|error| error.to_string())?) {
            Some(at) => Err(format!(
                "`{at}` does not fit its points: it was edited or damaged; calibrate anew"
            )),
            None => Ok((calibration, hash)),
        }
    }

    /// Returns it as text.
    pub fn to_toml(&self) -> String {
        let stored = Stored::of(self, self.reference.as_ref().map(hash_of));
        let text = toml::to_string(&stored);
        HEADER.to_owned() + &text.expect("a calibration has only numbers, texts and tables")
    }
}

fn refused(path: &Path, why: String) -> FileError {
    FileError {
        file: path.display().to_string(),
        why,
    }
}

/// Names the first value in which two trees differ by more than rounding; `None` if there is none.
fn difference(stored: &Value, made: &Value) -> Option<String> {
    let below = |key: &str, rest: String| match rest.is_empty() {
        true => key.to_owned(),
        false => format!("{key}.{rest}"),
    };
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|it| it as f64));
    match (stored, made) {
        (Value::Table(stored), Value::Table(made)) => {
            let keys = stored.keys().chain(made.keys());
            keys.into_iter()
                .find_map(|key| match (stored.get(key), made.get(key)) {
                    (Some(stored), Some(made)) => Some(below(key, difference(stored, made)?)),
                    _ => Some(key.clone()),
                })
        }
        (Value::Array(stored), Value::Array(made)) if stored.len() == made.len() => (1..)
            .zip(stored.iter().zip(made))
            .find_map(|(index, (stored, made))| {
                Some(below(&format!("{index}"), difference(stored, made)?))
            }),
        _ => {
            let is_near = number(stored)
                .zip(number(made))
                .is_some_and(|(a, b)| (a - b).abs() <= SAME + SAME_SHARE * a.abs().max(b.abs()));
            (!is_near && stored != made).then(String::new)
        }
    }
}

fn hash_of(picture: &GrayImage) -> String {
    let mut hasher = Sha256::new();
    hasher.update(picture.width().to_le_bytes());
    hasher.update(picture.as_raw());
    digest::hex(&hasher.finalize())
}

/// Returns whether a text is a date such as `2026-11-22`.
fn is_day(text: &str) -> bool {
    let read = text.parse::<Datetime>().ok();
    read.is_some_and(|read| read.date.is_some() && read.time.is_none())
}
