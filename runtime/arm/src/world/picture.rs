//! The task's square picture, cut from the camera's full picture; and the picture of the flat cloth.
//!
//! In: a shot in the camera's full size, or the file that the settings name. Out: the square picture of the task's
//! camera, with its camera model. Taking pictures and detecting a moved camera are left to the world.

use super::Parts;
use super::base_from_world;
use crate::calibration::{Calibration, check_window};
use crate::rgbd::Shot;
use crate::settings::Settings;
use crate::table::ClothTable;
use fab_picture::observation::{self, Observation};
use fab_picture::{dropouts, png};
use fab_world::WorldError;
use image::RgbImage;
use std::path::Path;

/// Reads the camera's own picture of the flat cloth that the settings name; `None` if they name none.
///
/// - `beside`: the folder of the settings.
///
/// Fails if it cannot be read, or its size differs from the calibrated camera's pictures.
pub(super) fn flat_picture(
    beside: &Path,
    settings: &Settings,
    calibration: &Calibration,
) -> Result<Option<RgbImage>, String> {
    let Some(named) = &settings.camera.flat else {
        return Ok(None);
    };
    let file = beside.join(named);
    let wrong = |why: String| format!("`camera.flat`, the picture of the flat cloth: {why}");
    let rgb = png::load(&file).map_err(|error| wrong(error.to_string()))?;
    let ([width, height], (found_width, found_height)) =
        (calibration.terms.size_px, rgb.dimensions());
    if [found_width, found_height] != [width, height] {
        return Err(wrong(format!(
            "`{}` has {found_width} x {found_height} px, and the calibrated camera's own pictures have {width} x {height}: \
             take it with that camera, and cut nothing off",
            file.display()
        )));
    }
    Ok(Some(rgb))
}

/// Takes the camera's own picture of the settings' simulated table, without a cloth.
pub fn simulated_table(settings: &Settings) -> Result<RgbImage, WorldError> {
    let table = ClothTable::new(settings, &base_from_world(settings), None)?;
    Ok(table.bare_shot()?.rgb)
}

/// Cuts the task's square picture out of the camera's own.
pub(super) fn square(parts: &Parts, shot: &Shot, time_s: f64) -> Result<Observation, WorldError> {
    let size_px = [shot.rgb.width(), shot.rgb.height()];
    let window = parts.files.settings.camera.window_px;
    check_window(window, size_px).map_err(|why| WorldError::Camera { why })?;
    let image_px = parts.image_px;
    let (closed, note) = dropouts::closed(&shot.depth_m);
    let world_from_base = base_from_world(&parts.files.settings).inverse();
    Ok(Observation {
        rgb: observation::cut_colours(&shot.rgb, window, image_px),
        depth_m: observation::cut_depth(&closed, window, image_px),
        camera: parts
            .files
            .calibration
            .camera(&world_from_base, window, image_px),
        time_s,
        notes: note.into_iter().collect(),
    })
}
