//! A camera backed by a folder into which another program writes pictures.
//!
//! In: a folder of `NAME.png` or `NAME.jpg`, each optionally with `NAME.depth.png` (16 bits, millimetres, 0 for no
//! reading), which is written first. Out: a picture written after the request, so that no rollout uses a picture from
//! before a motion as one from after it; or, if nothing moves, the newest picture.

use super::rgbd::{Intrinsics, RgbdError, RgbdSource, Shot};
use fab_base::files;
use fab_picture::DepthImage;
use fab_picture::png;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// The most files of a folder that are examined.
const MAX_FILES: usize = 10_000;

/// How often the folder is polled while waiting for a picture.
const LOOK: Duration = Duration::from_millis(50);

/// Which picture of a folder the camera returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureSelection {
    /// The newest by the time of its file, whenever it was written.
    Newest,
    /// One that is written after the request.
    Fresh {
        /// The longest to wait, seconds.
        timeout_s: f64,
    },
}

/// A folder of pictures.
#[derive(Clone, Debug)]
pub struct DirectoryCamera {
    folder: PathBuf,
    intrinsics: Option<Intrinsics>,
    selection: PictureSelection,
}

/// When a picture was written by this file system's clock, and its size.
type Written = (Option<SystemTime>, u64);

impl DirectoryCamera {
    /// Takes pictures from a folder, which may be empty.
    pub fn of(
        folder: &Path,
        intrinsics: Option<Intrinsics>,
        selection: PictureSelection,
    ) -> DirectoryCamera {
        DirectoryCamera {
            folder: folder.to_owned(),
            intrinsics,
            selection,
        }
    }

    /// Returns a picture that was added or changed after the call.
    fn fresh(&self, timeout_s: f64) -> Result<Shot, String> {
        let before = self.pictures()?;
        let begun = Instant::now();
        let mut why = "no new picture came".to_owned();
        while begun.elapsed().as_secs_f64() < timeout_s {
            std::thread::sleep(LOOK);
            let mut now = self.pictures()?;
            now.retain(|path, written| before.get(path) != Some(written));
            // A picture that is still being written becomes readable later.
            match newest(now).map(|path| self.read(&path)) {
                Some(Ok(shot)) => return Ok(shot),
                Some(Err(error)) => why = error,
                None => {}
            }
        }
        Err(format!(
            "within {timeout_s} s of `camera.timeout_s`: {why}; `{}` pictures lie there already",
            before.len()
        ))
    }

    fn pictures(&self) -> Result<HashMap<PathBuf, Written>, String> {
        let files = std::fs::read_dir(&self.folder).map_err(|error| error.to_string())?;
        let all: Vec<_> = files.take(MAX_FILES + 1).collect();
        if all.len() > MAX_FILES {
            return Err(format!(
                "it holds more than {MAX_FILES} files; take the old ones away"
            ));
        }
        let is_picture = |path: &PathBuf| {
            let is_of_kind = |ending| files::ends_in(path, ending);
            !path.to_string_lossy().ends_with(".depth.png")
                && ["png", "jpg", "jpeg"].into_iter().any(is_of_kind)
        };
        let paths = all.into_iter().filter_map(|file| Some(file.ok()?.path()));
        let pictures = paths.filter(is_picture).filter_map(|path| {
            let about = path.metadata().ok()?;
            Some((path, (about.modified().ok(), about.len())))
        });
        Ok(pictures.collect())
    }

    fn read(&self, path: &Path) -> Result<Shot, String> {
        let rgb = png::load(path).map_err(|error| error.to_string())?;
        let beside = path.with_extension("depth.png");
        let depth_m = if beside.exists() {
            png::load_depth(&beside).map_err(|error| error.to_string())?
        } else {
            DepthImage::new(rgb.width(), rgb.height())
        };
        Shot::aligned(rgb, depth_m, self.intrinsics.clone())
            .map_err(|why| format!("`{}`: {why}", path.display()))
    }
}

/// Returns the picture that was written last; of several at once, the last by name.
fn newest(pictures: HashMap<PathBuf, Written>) -> Option<PathBuf> {
    let timed = pictures.into_iter().map(|(path, (at, _))| (at, path));
    timed.max().map(|(_, path)| path)
}

impl RgbdSource for DirectoryCamera {
    fn name(&self) -> String {
        self.folder.display().to_string()
    }

    fn shoot(&mut self) -> Result<Shot, RgbdError> {
        let shot = match self.selection {
            PictureSelection::Newest => self.pictures().and_then(|pictures| {
                let path =
                    newest(pictures).ok_or("it holds no picture `NAME.png` or `NAME.jpg`")?;
                self.read(&path)
            }),
            PictureSelection::Fresh { timeout_s } => self.fresh(timeout_s),
        };
        shot.map_err(|why| RgbdError {
            camera: self.name(),
            why,
        })
    }
}

#[cfg(test)]
mod tests;
