//! The picture that a corner detector looks at.
//!
//! In: an observation, the cloth's mask, the sight to use. Out: a square 8-bit picture, black where there is no cloth.

use super::color::{gray_level, misread};
use fab_picture::has_reading;
use fab_picture::{DepthImage, Mask};
use fab_program::Sight;
use image::imageops::{self, FilterType};
use image::{GrayImage, Luma, RgbImage};

/// Grey levels per metre in a picture of depth, 1 cm per level (protocol, section 6).
const LEVELS_PER_METRE: f64 = 100.0;

/// Makes the picture, `side_px` squared: depth in centimetres, white, or grey; 0 where there is no cloth.
///
/// All three inputs have the same size. Values are averaged over cloth pixels alone, so neither the table nor missing
/// readings distort the cloth's rim. A pixel is cloth if at least half of its source area is.
pub(super) fn detector_picture(
    depth: &DepthImage,
    rgb: &RgbImage,
    mask: &Mask,
    of: Sight,
    side_px: u32,
) -> GrayImage {
    let size = depth.dimensions();
    let is_inside = |column, row| mask.contains_at(column, row);
    let grey = |shown: fn([u8; 3]) -> [u8; 3]| {
        scaled(
            size,
            side_px,
            // Sharpening overshoots a full share at the rim by an eighth; at half scale nothing is clipped.
            0.5,
            |column, row| {
                let level = gray_level(shown(rgb.get_pixel(column, row).0));
                is_inside(column, row).then_some(f32::from(level) / 255.0)
            },
            |fraction| (fraction * 255.0).round().clamp(0.0, 255.0) as u8,
        )
    };
    match of {
        Sight::Depth => {
            // `resize` keeps floats within 0 and 1, so depths are passed as fractions of the farthest one.
            let farthest_m = depth
                .pixels()
                .map(|pixel| pixel.0[0])
                .filter(|&depth_m| has_reading(depth_m))
                .fold(0.0, f32::max);
            let fraction = |column, row| {
                let depth_m = depth.get_pixel(column, row).0[0];
                (is_inside(column, row) && has_reading(depth_m)).then_some(depth_m / farthest_m)
            };
            scaled(size, side_px, 1.0, fraction, |fraction| {
                let level = (fraction * f64::from(farthest_m) * LEVELS_PER_METRE).round();
                // At least 1: cloth stays distinct from the background however near the camera is.
                level.clamp(1.0, 255.0) as u8
            })
        }
        Sight::Mask => scaled(
            size,
            side_px,
            1.0,
            |column, row| is_inside(column, row).then_some(1.0),
            |_| 255,
        ),
        Sight::Picture => grey(|color| color),
        Sight::MisreadPicture => grey(misread),
    }
}

/// Scales the values of cloth pixels, 0 to 1, and converts their averages to levels; 0 off the cloth.
///
/// `whole` is the value of a full cloth pixel; `resize` clips everything at 1.
fn scaled(
    (width, height): (u32, u32),
    side_px: u32,
    whole: f32,
    value: impl Fn(u32, u32) -> Option<f32>,
    level: impl Fn(f64) -> u8,
) -> GrayImage {
    if (width, height) == (side_px, side_px) {
        // Nothing is averaged here, and the two pictures below would cancel out.
        return GrayImage::from_fn(width, height, |column, row| {
            Luma([value(column, row).map_or(0, |value| level(f64::from(value)))])
        });
    }
    let share = DepthImage::from_fn(width, height, |column, row| {
        Luma([value(column, row).map_or(0.0, |_| whole)])
    });
    let weighted = DepthImage::from_fn(width, height, |column, row| {
        Luma([whole * value(column, row).unwrap_or(0.0)])
    });
    let resize = |picture| imageops::resize(picture, side_px, side_px, FilterType::CatmullRom);
    let (share, weighted) = (resize(&share), resize(&weighted));
    GrayImage::from_fn(side_px, side_px, |column, row| {
        let share = f64::from(share.get_pixel(column, row).0[0]);
        if share < 0.5 * f64::from(whole) {
            return Luma([0]);
        }
        Luma([level(
            f64::from(weighted.get_pixel(column, row).0[0]) / share,
        )])
    })
}
