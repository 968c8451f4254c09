//! Writes comparisons of pictures, before, after and difference, as files for people.
//!
//! In: a pending picture. Out: a PNG file in the named folder, or in a temporary one whose path is reported.

use super::difference::Compared;
use super::find::Pending;
use super::models;
use crate::exit::Failure;
use crate::io::write_file;
use std::path::PathBuf;

/// The place for such files.
pub struct Sheets {
    /// The folder; `None` if it is to be created for the first picture.
    folder: Option<PathBuf>,
}

/// A comparison that was written to a file.
pub struct Sheet {
    /// The file; `None` if this build cannot draw, or there is nothing to draw.
    pub path: Option<PathBuf>,
    /// The difference.
    pub compared: Compared,
}

impl Sheet {
    /// Describes the difference, and names the file that shows it.
    pub fn in_words(&self) -> String {
        match &self.path {
            Some(path) => format!(
                "{}\nbefore, after and difference: {}",
                self.compared.words,
                path.display()
            ),
            None => self.compared.words.clone(),
        }
    }
}

impl Sheets {
    /// Uses the named folder, if there is one.
    pub fn new(folder: Option<PathBuf>) -> Sheets {
        Sheets { folder }
    }

    /// Returns whether a folder was named.
    pub fn has_folder(&self) -> bool {
        self.folder.is_some()
    }

    /// Draws the pictures of a pending snapshot under a name; fails if the file cannot be written.
    pub fn draw(&mut self, name: &str, pending: &Pending) -> Result<Sheet, Failure> {
        let compared = models::compare(pending);
        let path = match &compared.png {
            Some(png) => {
                let path = self.made()?.join(format!("{name}.png"));
                write_file(&path, png)?;
                Some(path)
            }
            None => None,
        };
        Ok(Sheet { path, compared })
    }

    fn made(&mut self) -> Result<PathBuf, Failure> {
        if let Some(folder) = &self.folder {
            std::fs::create_dir_all(folder).map_err(|error| Failure::unwritable(folder, error))?;
            return Ok(folder.clone());
        }
        let mut number = 0;
        loop {
            let name = format!("fabc-review-{}-{number}", std::process::id());
            let folder = std::env::temp_dir().join(name);
            match std::fs::create_dir(&folder) {
                Ok(()) => {
                    self.folder = Some(folder.clone());
                    return Ok(folder);
                }
                // Somebody else's folder, or one of an earlier process with the same id.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(Failure::unwritable(&folder, error)),
            }
        }
    }
}
