//! Infers the camera and the cloth's size; pictures show only the ratio between them.

use super::DraftError;
use fab_program::{
    Camera, Cloth, ClothStart, ImageUp, PARTICLES_A_SIDE, RECORDED_SPACING_M, particles_along,
};
use fab_world::start::RESTING_HEIGHT_M;
use std::f64::consts::{FRAC_PI_4, PI};

/// The longest side of a cloth, metres.
const LARGEST_M: f64 = (PARTICLES_A_SIDE[1] - 1) as f64 * RECORDED_SPACING_M;

/// How much larger an outline in whole pixels is than the cloth, pixels: partly covered pixels count.
const RIM_PX: f64 = 0.7;

/// The height of the shipped folding tasks' camera, metres.
const HEIGHT_M: f64 = 0.65;

/// Heights and fields of view permitted for a task's camera, metres and radians.
const HEIGHTS_M: std::ops::RangeInclusive<f64> = 0.1..=5.0;
const VIEWS_RAD: std::ops::RangeInclusive<f64> = 5.0 * PI / 180.0..=150.0 * PI / 180.0;

/// The measures stated by the user.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StatedMeasures {
    /// The camera's height above the table, metres.
    pub height_m: Option<f64>,
    /// The flat cloth's longer side, metres.
    pub longer_m: Option<f64>,
}

/// Returns the camera and the cloth that produce a rectangle with these sides, pixels, in a picture.
///
/// Stated values are kept and the rest is derived: the cloth from the height, the height from the cloth, and the field
/// of view from both. If nothing is stated, the camera is that of the shipped folding tasks. Fails if a task may have
/// no such camera or cloth.
pub fn of(
    sides_px: [f64; 2],
    side_px: u32,
    stated: &StatedMeasures,
) -> Result<(Camera, Cloth), DraftError> {
    let sides_px = sides_px.map(|side| side - RIM_PX);
    let longer_px = sides_px[0].max(sides_px[1]);
    let half_px = f64::from(side_px) / 2.0;
    let focal_px = half_px / (FRAC_PI_4 / 2.0).tan();
    let (height_m, fov_rad) = match (stated.height_m, stated.longer_m) {
        (height_m, None) => (height_m.unwrap_or(HEIGHT_M), FRAC_PI_4),
        (None, Some(longer_m)) => {
            let height_m = longer_m * focal_px / longer_px + RESTING_HEIGHT_M;
            (to_steps(height_m, 1000.0), FRAC_PI_4)
        }
        (Some(height_m), Some(longer_m)) => {
            let focal_px = longer_px * (height_m - RESTING_HEIGHT_M) / longer_m;
            let fov_deg = 2.0 * (half_px / focal_px).atan().to_degrees();
            (height_m, to_steps(fov_deg, 10.0).to_radians())
        }
    };
    let longer_m = stated.longer_m.unwrap_or_else(|| {
        longer_px * (height_m - RESTING_HEIGHT_M) * (fov_rad / 2.0).tan() / half_px
    });
    if !(HEIGHTS_M.contains(&height_m) && VIEWS_RAD.contains(&fov_rad) && longer_m <= LARGEST_M) {
        let mm = |length_m: f64| length_m * 1000.0;
        return Err(DraftError::Unfit(format!(
            "a cloth of {:.0} mm that takes up {longer_px:.0} of {side_px} px needs a camera {:.0} mm above the table with \
             a field of view of {:.0} degrees; a task's camera is 100 to 5000 mm above it and sees 5 to 150 degrees, and \
             its cloth measures at most {:.0} mm",
            mm(longer_m),
            mm(height_m),
            fov_rad.to_degrees(),
            mm(LARGEST_M)
        )));
    }
    let [dimx, dimy] =
        sides_px.map(|side_px| particles_along(side_px / longer_px * longer_m, RECORDED_SPACING_M));
    let camera = Camera {
        height_m,
        fov_rad,
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

/// Rounds to a number with few digits.
fn to_steps(value: f64, steps: f64) -> f64 {
    (value * steps).round() / steps
}

#[cfg(test)]
#[path = "tests/measures.rs"]
mod tests;
