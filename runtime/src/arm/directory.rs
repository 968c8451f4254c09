//! A camera that is a folder: pictures with depth, one after the other in the order of their names.
//!
//! In: a folder of `NAME.png`, each perhaps with `NAME.depth.png` (16 bits, millimetres, 0 for no reading). Out: the next
//! picture at each shot; none is shown twice, so that a rollout never takes an old picture for a new one.

use super::rgbd::{Intrinsics, RgbdError, RgbdSource, Shot};
use crate::picture;
use crate::vision::DepthImage;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The most files of a folder that are looked at.
const MAX_FILES: usize = 10_000;

/// A folder of pictures.
#[derive(Debug)]
pub struct DirectoryCamera {
    folder: PathBuf,
    intrinsics: Option<Intrinsics>,
    shown: BTreeSet<PathBuf>,
}

impl DirectoryCamera {
    /// Takes pictures from a folder, which need not hold any yet.
    pub fn of(folder: &Path, intrinsics: Option<Intrinsics>) -> DirectoryCamera {
        DirectoryCamera {
            folder: folder.to_owned(),
            intrinsics,
            shown: BTreeSet::new(),
        }
    }

    /// Returns the first picture, by name, that was not shown yet.
    fn next(&self) -> Result<PathBuf, String> {
        let files = std::fs::read_dir(&self.folder).map_err(|error| error.to_string())?;
        let is_picture = |path: &PathBuf| {
            let name = path.file_name().and_then(|name| name.to_str());
            name.is_some_and(|name| name.ends_with(".png") && !name.ends_with(".depth.png"))
        };
        let next = files
            .take(MAX_FILES)
            .filter_map(|file| Some(file.ok()?.path()))
            .filter(|path| is_picture(path) && !self.shown.contains(path))
            .min();
        next.ok_or_else(|| {
            format!(
                "its `{}` pictures were all shown; put the next one there as `NAME.png`, with a name after theirs",
                self.shown.len()
            )
        })
    }
}

impl RgbdSource for DirectoryCamera {
    fn name(&self) -> String {
        self.folder.display().to_string()
    }

    fn shoot(&mut self) -> Result<Shot, RgbdError> {
        let failed = |why: String| RgbdError {
            camera: self.folder.display().to_string(),
            why,
        };
        let path = self.next().map_err(failed)?;
        let rgb = picture::load(&path).map_err(|error| failed(error.to_string()))?;
        let beside = path.with_extension("depth.png");
        let depth_m = match beside.exists() {
            true => picture::load_depth(&beside).map_err(|error| failed(error.to_string()))?,
            false => DepthImage::new(rgb.width(), rgb.height()),
        };
        if depth_m.dimensions() != rgb.dimensions() {
            return Err(failed(format!(
                "`{}` has {} x {} px and its depth {} x {}: they must be aligned",
                path.display(),
                rgb.width(),
                rgb.height(),
                depth_m.width(),
                depth_m.height()
            )));
        }
        self.shown.insert(path);
        Ok(Shot {
            rgb,
            depth_m,
            intrinsics: self.intrinsics.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use image::{Rgb, RgbImage};

    #[test]
    fn pictures_are_shown_once_in_the_order_of_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, level: u8| {
            let picture = RgbImage::from_pixel(4, 3, Rgb([level; 3]));
            std::fs::write(folder.path().join(name), picture::encode(&picture)).unwrap();
        };
        put("b.png", 2);
        put("a.png", 1);
        let mut camera = DirectoryCamera::of(folder.path(), None);
        let level = |camera: &mut DirectoryCamera| camera.shoot().unwrap().rgb.get_pixel(0, 0).0[0];
        assert_eq!(level(&mut camera), 1);
        assert_eq!(level(&mut camera), 2);
        let why = camera.shoot().unwrap_err().why;
        assert!(why.contains("its `2` pictures were all shown"), "{why}");
        put("c.png", 3);
        assert_eq!(level(&mut camera), 3);
    }

    #[test]
    fn a_depth_of_another_size_and_a_missing_folder_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: Vec<u8>| {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        };
        write("a.png", picture::encode(&RgbImage::new(4, 3)));
        write(
            "a.depth.png",
            picture::encode_gray(&image::GrayImage::new(5, 3)),
        );
        let mut camera = DirectoryCamera::of(folder.path(), None);
        let why = camera.shoot().unwrap_err().why;
        assert!(why.contains("4 x 3 px and its depth 5 x 3"), "{why}");
        let mut missing = DirectoryCamera::of(&folder.path().join("none"), None);
        assert!(missing.shoot().is_err());
    }
}
