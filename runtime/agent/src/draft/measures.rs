//! Infers the camera and the cloth's size; pictures show only the ratio between them.

use crate::error::RunError;
use fab_program::{
    Camera, Cloth, ClothStart, ImageUp, PARTICLES_A_SIDE, RECORDED_SPACING_M, particles_along,
};
use fab_world::start::RESTING_HEIGHT_M;
use std::f64::consts::FRAC_PI_4;
use std::ops::RangeInclusive;

/// The longest side of a cloth, metres.
const LARGEST_M: f64 = (PARTICLES_A_SIDE[1] - 1) as f64 * RECORDED_SPACING_M;

/// How much larger an outline in whole pixels is than the cloth, pixels: partly covered pixels count.
const RIM_PX: f64 = 0.7;

/// The height and the field of view of the shipped folding tasks' camera, metres and radians.
const HEIGHT_M: f64 = 0.65;
const VIEW_RAD: f64 = FRAC_PI_4;

/// Heights permitted for a task's camera, metres.
const HEIGHTS_M: RangeInclusive<f64> = 0.1..=5.0;

/// Returns the camera and the cloth that produce a rectangle with these sides, pixels, in a picture.
///
/// - `longer_m`: the flat cloth's longer side, metres, if the user stated it: the camera's height follows from it.
///   Otherwise the camera is that of the shipped folding tasks, and the cloth's size follows.
///
/// Fails if a task may have no such camera or cloth.
pub fn of(
    sides_px: [f64; 2],
    side_px: u32,
    longer_m: Option<f64>,
) -> Result<(Camera, Cloth), RunError> {
    let sides_px = sides_px.map(|side| side - RIM_PX);
    let longer_px = sides_px[0].max(sides_px[1]);
    let focal_px = f64::from(side_px) / 2.0 / (VIEW_RAD / 2.0).tan();
    let height_m = longer_m.map_or(HEIGHT_M, |longer_m| {
        let height_m = longer_m * focal_px / longer_px + RESTING_HEIGHT_M;
        (height_m * 1000.0).round() / 1000.0
    });
    let longer_m = longer_m.unwrap_or(longer_px * (height_m - RESTING_HEIGHT_M) / focal_px);
    if !(HEIGHTS_M.contains(&height_m) && longer_m <= LARGEST_M) {
        let mm = |length_m: f64| length_m * 1000.0;
        return Err(RunError::Failed(format!(
            "a cloth of {:.0} mm that takes up {longer_px:.0} of {side_px} px needs a camera {:.0} mm above the table; a \
             task's camera is 100 to 5000 mm above it, and its cloth measures at most {:.0} mm",
            mm(longer_m),
            mm(height_m),
            mm(LARGEST_M)
        )));
    }
    let [dimx, dimy] =
        sides_px.map(|side_px| particles_along(side_px / longer_px * longer_m, RECORDED_SPACING_M));
    let camera = Camera {
        height_m,
        fov_rad: VIEW_RAD,
        image_px: side_px,
        up: ImageUp::Y,
    };
    let cloth = Cloth {
        dimx,
        dimy,
        spacing_m: RECORDED_SPACING_M,
        start: ClothStart::Flat,
        material: None,
    };
    Ok((camera, cloth))
}

#[cfg(test)]
#[path = "tests/measures.rs"]
mod tests;
