//! A camera backed by a folder into which another program writes pictures.
//!
//! In: a folder of `NAME.png` or `NAME.jpg`, each optionally with `NAME.depth.png` (16 bits, millimetres, 0 for no
//! reading), which is written first. Out: a picture written after the request, so that no rollout uses a picture from
//! before a motion as one from after it; or, if nothing moves, the newest picture.

use super::rgbd::{Intrinsics, RgbdSource, Shot};
use fab_base::files;
use fab_picture::png;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

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

/// A picture: when it was written by this file system's clock, its path, and its size.
type Written = (SystemTime, PathBuf, u64);

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

    /// Returns a picture that was written after the call.
    fn fresh(&self, timeout_s: f64) -> Result<Shot, String> {
        let before = self.newest()?;
        let begun = Instant::now();
        let mut why = "no new picture came".to_owned();
        while begun.elapsed().as_secs_f64() < timeout_s {
            std::thread::sleep(LOOK);
            // If the newest was removed, the one before it is not new.
            let now = self.newest()?.filter(|now| Some(now) > before.as_ref());
            // A picture that is still being written becomes readable later.
            match now.map(|(_, path, _)| self.read(&path)) {
                Some(Ok(shot)) => return Ok(shot),
                Some(Err(error)) => why = error,
                None => {}
            }
        }
        Err(format!("within {timeout_s} s of `camera.timeout_s`: {why}"))
    }

    /// Returns the picture that was written last; of several at once, the last by name.
    fn newest(&self) -> Result<Option<Written>, String> {
        let files = std::fs::read_dir(&self.folder).map_err(|error| error.to_string())?;
        let is_picture = |path: &PathBuf| {
            let is_of_kind = |ending| files::ends_in(path, ending);
            !path.to_string_lossy().ends_with(".depth.png")
                && ["png", "jpg", "jpeg"].into_iter().any(is_of_kind)
        };
        let paths = files.filter_map(|file| Some(file.ok()?.path()));
        let pictures = paths.filter(is_picture).filter_map(|path| {
            let about = path.metadata().ok()?;
            Some((about.modified().ok()?, path, about.len()))
        });
        Ok(pictures.max())
    }

    fn read(&self, path: &Path) -> Result<Shot, String> {
        let rgb = png::load(path).map_err(|error| error.to_string())?;
        let beside = path.with_extension("depth.png");
        let depth_m = beside
            .exists()
            .then(|| png::load_depth(&beside))
            .transpose();
        let depth_m = depth_m.map_err(|error| error.to_string())?;
        Shot::aligned(rgb, depth_m, self.intrinsics.clone())
            .map_err(|why| format!("`{}`: {why}", path.display()))
    }
}

impl RgbdSource for DirectoryCamera {
    fn name(&self) -> String {
        self.folder.display().to_string()
    }

    fn shoot(&mut self) -> Result<Shot, String> {
        let PictureSelection::Fresh { timeout_s } = self.selection else {
            let newest = self.newest()?;
            let (_, path, _) = newest.ok_or("it holds no picture `NAME.png` or `NAME.jpg`")?;
            return self.read(&path);
        };
        self.fresh(timeout_s)
    }
}

#[cfg(test)]
mod tests;
