//! Cuts the square picture of a task's camera out of another picture, and scales it.
//!
//! In: a picture, and a square `[left, top, side]` in its pixels. Out: the square in the camera's size. Colour and depth
//! are cut alike, so aligned pictures stay aligned.

use crate::DepthImage;
use image::RgbImage;
use image::imageops::{self, FilterType};

/// Returns the largest square in the middle of a picture.
pub fn middle((width, height): (u32, u32)) -> [u32; 3] {
    let side = width.min(height);
    [(width - side) / 2, (height - side) / 2, side]
}

/// Cuts and scales colours, which are averaged.
///
/// The square lies in the picture.
pub fn colours(rgb: &RgbImage, [left, top, side]: [u32; 3], image_px: u32) -> RgbImage {
    let rgb = imageops::crop_imm(rgb, left, top, side, side).to_image();
    if side == image_px {
        return rgb;
    }
    imageops::resize(&rgb, image_px, image_px, FilterType::Triangle)
}

/// Cuts and scales readings. The mean of a near and a far one is a point on neither surface, so each is one pixel's.
///
/// The square lies in the picture.
pub fn depth(depth_m: &DepthImage, [left, top, side]: [u32; 3], image_px: u32) -> DepthImage {
    DepthImage::from_fn(image_px, image_px, |column, row| {
        let raw = |at: u32| (2 * u64::from(at) + 1) * u64::from(side) / (2 * u64::from(image_px));
        *depth_m.get_pixel(left + raw(column) as u32, top + raw(row) as u32)
    })
}
