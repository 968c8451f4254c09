//! A camera backed by a folder into which another program writes pictures.
//!
//! In: a folder of `NAME.png` or `NAME.jpg`, each optionally with `NAME.depth.png` (16 bits, millimetres, 0 for no
//! reading), which is written first. Out: a picture written after the request, so that no rollout uses a picture from
//! before a motion as one from after it; or, if nothing moves, the last picture by name.

use super::rgbd::{Intrinsics, RgbdError, RgbdSource, Shot};
use fab_base::files;
use fab_picture::DepthImage;
use fab_picture::png;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// The most files of a folder that are examined.
const MAX_FILES: usize = 10_000;

/// How often the folder is polled while waiting for a picture.
const LOOK: Duration = Duration::from_millis(50);

/// Which picture of a folder the camera returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureSelection {
    /// The last by name, whenever it was written.
    Last,
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

/// Pictures with their sizes and modification times, by this file system's clock.
type Listed = BTreeMap<PathBuf, (u64, Option<SystemTime>)>;

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
        let before = listed(&self.folder)?;
        let begun = Instant::now();
        let mut why = "no new picture came".to_owned();
        while begun.elapsed().as_secs_f64() < timeout_s {
            std::thread::sleep(LOOK);
            let now = listed(&self.folder)?;
            let is_new = |(path, about): &(&PathBuf, &_)| before.get(*path) != Some(*about);
            let Some((path, _)) = now.iter().rfind(is_new) else {
                continue;
            };
            // A picture that is still being written becomes readable later.
            match self.read(path) {
                Ok(shot) => return Ok(shot),
                Err(error) => why = error,
            }
        }
        Err(format!(
            "within {timeout_s} s of `camera.timeout_s`: {why}; `{}` pictures lie there already",
            before.len()
        ))
    }

    fn last(&self) -> Result<Shot, String> {
        let last = last_picture(&self.folder)?;
        self.read(&last.ok_or("it holds no picture `NAME.png` or `NAME.jpg`")?)
    }

    fn read(&self, path: &Path) -> Result<Shot, String> {
        let rgb = png::load(path).map_err(|error| error.to_string())?;
        let beside = path.with_extension("depth.png");
        let depth_m = match beside.exists() {
            true => png::load_depth(&beside).map_err(|error| error.to_string())?,
            false => DepthImage::new(rgb.width(), rgb.height()),
        };
        if depth_m.dimensions() != rgb.dimensions() {
            return Err(format!(
                "`{}` has {} x {} px and its depth {} x {}: they must be aligned",
                path.display(),
                rgb.width(),
                rgb.height(),
                depth_m.width(),
                depth_m.height()
            ));
        }
        Ok(Shot {
            rgb,
            depth_m,
            intrinsics: self.intrinsics.clone(),
        })
    }
}

/// Returns the last picture of a folder by name; the error says why the folder cannot be read.
pub fn last_picture(folder: &Path) -> Result<Option<PathBuf>, String> {
    Ok(listed(folder)?.into_keys().next_back())
}

fn listed(folder: &Path) -> Result<Listed, String> {
    let files = std::fs::read_dir(folder).map_err(|error| error.to_string())?;
    let is_picture = |path: &PathBuf| {
        let is_depth = path.to_string_lossy().ends_with(".depth.png");
        !is_depth
            && ["png", "jpg", "jpeg"]
                .iter()
                .any(|ending| files::ends_in(path, ending))
    };
    let all: Vec<_> = files.take(MAX_FILES + 1).collect();
    if all.len() > MAX_FILES {
        return Err(format!(
            "it holds more than {MAX_FILES} files; take the old ones away"
        ));
    }
    let described = |path: PathBuf| {
        let about = path.metadata().ok()?;
        Some((path, (about.len(), about.modified().ok())))
    };
    let paths = all.into_iter().filter_map(|file| Some(file.ok()?.path()));
    Ok(paths.filter(is_picture).filter_map(described).collect())
}

impl RgbdSource for DirectoryCamera {
    fn name(&self) -> String {
        self.folder.display().to_string()
    }

    fn shoot(&mut self) -> Result<Shot, RgbdError> {
        let shot = match self.selection {
            PictureSelection::Last => self.last(),
            PictureSelection::Fresh { timeout_s } => self.fresh(timeout_s),
        };
        shot.map_err(|why| RgbdError {
            camera: self.name(),
            why,
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use image::{Rgb, RgbImage};
    use std::sync::mpsc::channel;

    fn encoded(level: u8) -> Vec<u8> {
        png::encode(&RgbImage::from_pixel(4, 3, Rgb([level; 3])))
    }

    fn level(camera: &mut DirectoryCamera) -> u8 {
        camera.shoot().unwrap().rgb.get_pixel(0, 0).0[0]
    }

    #[test]
    fn a_picture_of_before_is_never_taken_for_a_new_one() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes);
        put("b.png", &encoded(2)).unwrap();
        let short = PictureSelection::Fresh { timeout_s: 0.2 };
        let mut camera = DirectoryCamera::of(folder.path(), None, short);
        let why = camera.shoot().unwrap_err().why;
        assert!(why.contains("no new picture came; `1` pictures"), "{why}");

        let long = PictureSelection::Fresh { timeout_s: 60.0 };
        let mut camera = DirectoryCamera::of(folder.path(), None, long);
        let (send, taken) = channel();
        let waiting = std::thread::spawn(move || {
            for _ in 0..2 {
                send.send(level(&mut camera)).unwrap();
            }
        });
        // A name that sorts before the old one, half written at first; then the old name with another picture.
        let whole = encoded(7);
        put("a.png", &whole[..20]).unwrap();
        std::thread::sleep(4 * LOOK);
        let mut levels = [(0_u8, 0_u8); 2];
        for (index, name) in ["a.png", "b.png"].into_iter().enumerate() {
            let mut sent = 7 + 100 * index as u8;
            // Written repeatedly until it is seen, because the test cannot tell when the camera starts polling.
            levels[index] = loop {
                sent += 1;
                put(name, &encoded(sent)).unwrap();
                if let Ok(seen) = taken.recv_timeout(20 * LOOK) {
                    break (seen, sent);
                }
            };
        }
        waiting.join().unwrap();
        for ((seen, sent), least) in levels.into_iter().zip([8, 108]) {
            assert!((least..=sent).contains(&seen), "{levels:?}");
        }
    }

    #[test]
    fn where_nothing_moves_the_last_by_name_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        let mut camera = DirectoryCamera::of(folder.path(), None, PictureSelection::Last);
        let why = camera.shoot().unwrap_err().why;
        assert!(why.contains("holds no picture"), "{why}");
        for (name, level) in [("b.png", 2), ("a.png", 1)] {
            std::fs::write(folder.path().join(name), encoded(level)).unwrap();
        }
        assert_eq!((level(&mut camera), level(&mut camera)), (2, 2));
    }

    #[test]
    fn a_depth_of_another_size_and_a_missing_folder_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: Vec<u8>| {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        };
        write("a.png", png::encode(&RgbImage::new(4, 3)));
        write("a.depth.png", png::encode(&image::GrayImage::new(5, 3)));
        let mut camera = DirectoryCamera::of(folder.path(), None, PictureSelection::Last);
        let why = camera.shoot().unwrap_err().why;
        assert!(why.contains("4 x 3 px and its depth 5 x 3"), "{why}");
        for selection in [
            PictureSelection::Last,
            PictureSelection::Fresh { timeout_s: 0.2 },
        ] {
            let none = folder.path().join("none");
            assert!(DirectoryCamera::of(&none, None, selection).shoot().is_err());
        }
    }
}
