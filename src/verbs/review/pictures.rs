//! Shows how a picture changed: before, after and the difference as one file, and the difference in words.
//!
//! In: a pending picture. Out: a PNG file in the named folder, or in a temporary one whose path is reported. The
//! authoring tool cannot draw.

#[cfg(feature = "runtime")]
mod compare;

use super::find::Pending;
use crate::exit::Failure;
use crate::io::write_file;
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

/// The place for comparisons.
pub struct Sheets {
    /// The folder; `None` until a temporary one is needed.
    pub folder: Option<PathBuf>,
}

/// The difference between two pictures.
#[derive(Default)]
struct Compared {
    /// Before, after and difference side by side, as a PNG file; `None` if nothing can be drawn.
    png: Option<Vec<u8>>,
    /// The difference in words.
    words: String,
    /// How many pixels differ, if known.
    n_changed: Option<u64>,
    /// Leftmost column, top row, rightmost column and bottom row of those, pixels.
    bounds: Option<[u32; 4]>,
}

/// A comparison that was written to a file.
pub struct Sheet {
    /// The file; `None` if nothing can be drawn.
    path: Option<PathBuf>,
    compared: Compared,
}

impl Sheet {
    /// Describes the difference, and names the file that shows it.
    pub fn in_words(&self) -> String {
        let words = &self.compared.words;
        match &self.path {
            Some(path) => format!("{words}\nbefore, after and difference: {}", path.display()),
            None => words.clone(),
        }
    }

    /// Returns the same for `--json`.
    pub fn to_json(&self) -> Value {
        let compared = &self.compared;
        json!({ "path": self.path, "changed_pixels": compared.n_changed, "bounds": compared.bounds, "words": compared.words })
    }
}

impl Sheets {
    /// Draws the pictures of a pending snapshot under a name; fails if the file cannot be written.
    pub fn draw(&mut self, name: &str, pending: &Pending) -> Result<Sheet, Failure> {
        let compared = compare(pending);
        let path = match &compared.png {
            Some(png) => {
                let temporary =
                    || std::env::temp_dir().join(format!("fabc-review-{}", std::process::id()));
                let folder = self.folder.get_or_insert_with(temporary);
                fs::create_dir_all(&*folder).map_err(|error| Failure::unwritable(folder, error))?;
                let path = folder.join(format!("{name}.png"));
                write_file(&path, png)?;
                Some(path)
            }
            None => None,
        };
        Ok(Sheet { path, compared })
    }
}

#[cfg(feature = "runtime")]
fn compare(pending: &Pending) -> Compared {
    let Some(pictures) = pending.pictures() else {
        return Compared {
            words: "a text became a picture, or a picture a text".to_owned(),
            ..Compared::default()
        };
    };
    let file = pending.path.with_added_extension("png");
    let accepted = pending.path.with_extension("png");
    compare::compare(pictures, [&accepted, &file])
}

#[cfg(not(feature = "runtime"))]
fn compare(_: &Pending) -> Compared {
    Compared {
        words: "the pictures differ; this build of fabc cannot draw them".to_owned(),
        ..Compared::default()
    }
}
