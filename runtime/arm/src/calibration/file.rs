//! A calibration as text, with the camera's picture beside it.
//!
//! In: a calibration or a file. Out: the other. The file holds the points; the map and the errors are computed anew when
//! it is read.

use super::{Calibration, MAX_PAIRS, Pair, Terms};
use fab_base::{digest, files};
use fab_picture::png;
use image::GrayImage;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Version of the file format.
const FORMAT: i64 = 2;
/// The longest file accepted.
pub(super) const MAX_BYTES: u64 = 1 << 20;

/// A file's content, in its order.
#[derive(Serialize, Deserialize)]
struct Stored {
    format: i64,
    made_on: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference_sha256: Option<String>,
    terms: Terms,
    points: Vec<Pair>,
}

impl Calibration {
    /// Returns the path of the camera's picture beside a calibration file, a PNG file.
    pub fn picture_beside(path: &Path) -> PathBuf {
        path.with_extension("png")
    }

    /// Writes it, picture first; replaces existing files. The error names the file.
    ///
    /// A crash between the two leaves a file that [`Calibration::load`] refuses, because it names its picture's hash.
    pub fn save(&self, path: &Path) -> Result<(), String> {
        let write = |path: &Path, bytes: &[u8]| {
            files::write_whole(path, bytes)
                .map_err(|error| refused(path, format!("cannot be written: {error}")))
        };
        if let Some(reference) = &self.reference {
            write(&Calibration::picture_beside(path), &png::encode(reference))?;
        }
        write(path, self.to_toml().as_bytes())
    }

    /// Reads a file, and its picture if it names one, and fits its points. The error names the file.
    pub fn load(path: &Path) -> Result<Calibration, String> {
        let unusable = |why: String| refused(path, format!("is not a usable calibration: {why}"));
        let text = files::read_text(path, MAX_BYTES)
            .map_err(|why| refused(path, format!("cannot be read: {why}")))?;
        let stored: Stored = toml::from_str(&text).map_err(|error| unusable(error.to_string()))?;
        if stored.format != FORMAT {
            return Err(unusable(format!(
                "its format is {}, and this fabc reads {FORMAT}; calibrate anew",
                stored.format
            )));
        }
        if stored.points.len() > MAX_PAIRS {
            return Err(unusable(format!("it has more than {MAX_PAIRS} points")));
        }
        let reference = match &stored.reference_sha256 {
            None => None,
            Some(hash) => {
                let beside = Calibration::picture_beside(path);
                let reference = png::load(&beside).map_err(|error| unusable(error.to_string()))?;
                let reference = image::imageops::grayscale(&reference);
                if hash_of(&reference) != *hash {
                    let why = "is not the picture that the calibration beside it was made with; calibrate anew";
                    return Err(refused(&beside, why.to_owned()));
                }
                Some(reference)
            }
        };
        Calibration::make(stored.terms, stored.points, &stored.made_on, reference)
            .map_err(|refusal| unusable(format!("its points are refused: {refusal}")))
    }

    /// Returns it as text.
    pub fn to_toml(&self) -> String {
        let stored = Stored {
            format: FORMAT,
            made_on: self.made_on.clone(),
            reference_sha256: self.reference.as_ref().map(hash_of),
            terms: self.terms.clone(),
            points: self.pairs.clone(),
        };
        let text = toml::to_string(&stored);
        let text = text.expect("a calibration has only numbers, texts and tables");
        format!(
            "# Written by `fabc calibrate`: the points that the camera saw and the arm touched.\n{text}"
        )
    }
}

fn refused(path: &Path, why: String) -> String {
    format!("`{}` {why}", path.display())
}

fn hash_of(picture: &GrayImage) -> String {
    let mut hasher = Sha256::new();
    hasher.update(picture.width().to_le_bytes());
    hasher.update(picture.as_raw());
    digest::hex(&hasher.finalize())
}
