//! A calibration as text, with the camera's picture beside it.
//!
//! In: a calibration or a file. Out: the other. The file holds the points; the map and the errors are computed anew when
//! it is read. Keys of earlier versions, which repeated what follows from the points, are passed over.

use super::{Calibration, Pair, Terms};
use fab_base::files;
use fab_picture::png;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the file format.
const FORMAT: i64 = 2;
/// The longest file accepted.
const MAX_BYTES: u64 = 1 << 20;

/// A file's content, in its order.
#[derive(Serialize, Deserialize)]
struct Stored {
    format: i64,
    made_on: String,
    terms: Terms,
    points: Vec<Pair>,
}

impl Calibration {
    /// Returns the path of the camera's picture beside a calibration file, a PNG file.
    pub fn picture_beside(path: &Path) -> PathBuf {
        path.with_extension("png")
    }

    /// Writes it, picture first; replaces existing files. The error names the file.
    pub fn save(&self, path: &Path) -> Result<(), String> {
        let write = |path: &Path, bytes: &[u8]| {
            files::write_whole(path, bytes)
                .map_err(|error| format!("`{}` cannot be written: {error}", path.display()))
        };
        if let Some(reference) = &self.reference {
            write(&Calibration::picture_beside(path), &png::encode(reference))?;
        }
        write(path, self.to_toml().as_bytes())
    }

    /// Reads a file and the picture beside it, if there is one, and fits its points. The error names the file.
    pub fn load(path: &Path) -> Result<Calibration, String> {
        let read = || {
            let text = files::read_text(path, MAX_BYTES)?;
            let stored: Stored = toml::from_str(&text).map_err(|error| error.to_string())?;
            if stored.format != FORMAT {
                return Err(format!(
                    "its format is {}, and this fabc reads {FORMAT}; calibrate anew",
                    stored.format
                ));
            }
            let beside = Calibration::picture_beside(path);
            let reference = beside.exists().then(|| png::load(&beside)).transpose();
            let reference = reference.map_err(|error| error.to_string())?;
            let reference = reference.map(|picture| image::imageops::grayscale(&picture));
            Calibration::make(stored.terms, stored.points, &stored.made_on, reference)
        };
        read().map_err(|why| format!("`{}` is not a usable calibration: {why}", path.display()))
    }

    /// Returns it as text.
    pub fn to_toml(&self) -> String {
        let stored = Stored {
            format: FORMAT,
            made_on: self.made_on.clone(),
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
