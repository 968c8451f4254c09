//! The task's square picture, cut from the camera's full picture; and the picture of the flat cloth.
//!
//! In: a shot in the camera's full size, or the file that the settings name. Out: the square picture of the task's
//! camera, with its camera model. Taking pictures and detecting a moved camera are left to the world.

use super::Parts;
use super::base_from_world;
use crate::calibration::{Calibration, Window};
use crate::rgbd::Shot;
use crate::settings::Settings;
use crate::table::ClothTable;
use fab_picture::observation::{self, Observation};
use fab_picture::{DepthImage, dropouts, png};
use fab_world::WorldError;
use image::RgbImage;
use std::path::Path;

/// The camera's own picture of the flat cloth, in the size that the calibration is for.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatPicture(RgbImage);

impl FlatPicture {
    /// Reads the picture named in the settings; `None` if they name none.
    ///
    /// - `path`: the settings file; the picture's path is relative to it.
    ///
    /// Fails if it cannot be read, or its size differs from the calibrated camera's pictures.
    pub fn load(
        path: &Path,
        settings: &Settings,
        calibration: &Calibration,
    ) -> Result<Option<FlatPicture>, String> {
        let Some(named) = &settings.camera.flat else {
            return Ok(None);
        };
        let file = path.parent().unwrap_or(Path::new(".")).join(named);
        let wrong = |why: String| format!("`camera.flat`, the picture of the flat cloth: {why}");
        let rgb = png::load(&file).map_err(|error| wrong(error.to_string()))?;
        let [width, height] = calibration.terms.size_px;
        if [rgb.width(), rgb.height()] != [width, height] {
            return Err(wrong(format!(
                "`{}` has {} x {} px, and the calibrated camera's own pictures have {width} x {height}: take it with that camera, and cut nothing off",
                file.display(),
                rgb.width(),
                rgb.height()
            )));
        }
        Ok(Some(FlatPicture(rgb)))
    }

    /// Returns it as a shot without depth readings.
    pub(super) fn shot(&self) -> Shot {
        Shot {
            rgb: self.0.clone(),
            depth_m: DepthImage::new(self.0.width(), self.0.height()),
            intrinsics: None,
        }
    }

    /// Returns its pixels, row by row.
    pub(super) fn bytes(&self) -> &[u8] {
        self.0.as_raw()
    }
}

/// Takes the camera's own picture of the settings' simulated table, without a cloth.
pub fn simulated_table(settings: &Settings) -> Result<RgbImage, WorldError> {
    let table = ClothTable::new(settings, &base_from_world(settings))?;
    Ok(table.bare_shot()?.rgb)
}

/// Cuts the task's square picture out of the camera's own.
pub(super) fn square(parts: &Parts, shot: &Shot, time_s: f64) -> Result<Observation, WorldError> {
    let size_px = [shot.rgb.width(), shot.rgb.height()];
    let window = Window::from(parts.settings.camera.window_px);
    if !window.is_in(size_px) {
        return Err(WorldError::Camera {
            why: format!(
                "its picture has {} x {} px, and `window_px` goes beyond it",
                size_px[0], size_px[1]
            ),
        });
    }
    let square = [window.left_px, window.top_px, window.side_px];
    let image_px = parts.image_px;
    let (closed, note) = dropouts::closed(&shot.depth_m);
    let world_from_base = base_from_world(&parts.settings).inverse();
    Ok(Observation {
        rgb: observation::cut_colours(&shot.rgb, square, image_px),
        depth_m: observation::cut_depth(&closed, square, image_px),
        camera: parts
            .calibration
            .camera(&world_from_base, &window, image_px),
        time_s,
        notes: note.into_iter().collect(),
    })
}
