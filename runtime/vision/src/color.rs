//! Colours of single pixels: masks by hue, saturation and value, and the grey that detectors see.
//!
//! In: an RGB picture. Out: a [`Mask`], grey levels, or other colours. No picture library does the rounding: results
//! depend on a pixel's three bytes alone.

use fab_picture::Mask;
use fab_program::hsv;
use image::RgbImage;
use std::cell::Cell;

/// Collects the pixels whose colour lies within three ranges, both ends included.
///
/// `hue_deg` is in degrees, 0 to 360 with red at 0, yellow at 60; a range whose end is below its start passes through
/// 360, and one that touches 360 includes 0. `saturation` and `value` run from 0 to 1. Greys have hue 0 and saturation
/// 0, black has value 0 too. A range that holds a NaN includes nothing.
pub fn color_mask(
    rgb: &RgbImage,
    hue_deg: [f64; 2],
    saturation: [f64; 2],
    value: [f64; 2],
) -> Mask {
    let within = |x: f64, [low, high]: [f64; 2]| low <= x && x <= high;
    let has_hue = |hue: f64| {
        let [low, high] = hue_deg;
        if low <= high {
            within(hue, hue_deg)
        } else {
            high < low && (hue >= low || hue <= high)
        }
    };
    let is_within = |color: [u8; 3]| {
        let [hue, s, v] = hsv(color);
        within(s, saturation)
            && within(v, value)
            // Red is at both ends of the scale.
            && (has_hue(hue) || (hue == 0.0 && has_hue(360.0)))
    };
    // Most pixels have the same colour as the one before.
    let last = Cell::new(([0; 3], is_within([0; 3])));
    Mask::from_fn(rgb.width(), rgb.height(), |column, row| {
        let color = rgb.get_pixel(column, row).0;
        if last.get().0 != color {
            last.set((color, is_within(color)));
        }
        last.get().1
    })
}

/// Returns a copy of a picture in which a mask's pixels are white.
///
/// The smoothing paper's detector must ignore the edge between a cloth's two colours, so it is shown the pink underside
/// in white (protocol, section 4, item 2).
pub fn painted_white(rgb: &RgbImage, mask: &Mask) -> RgbImage {
    let mut painted = rgb.clone();
    for pixel in mask.pixels() {
        // If the mask has another size than the picture, only their common part is painted.
        if let Some(level) = painted.get_pixel_mut_checked(pixel.u as u32, pixel.v as u32) {
            level.0 = [255; 3];
        }
    }
    painted
}

/// Reads a blue, green, red triple as hue, saturation and value, and returns the colour that it then means.
///
/// This reproduces a mistake in the paper's code: it converts BGR by `COLOR_HSV2RGB` and treats the result as BGR again
/// (protocol, section 4, item 2), so the result's red is used as blue. Hue counts halves of a degree.
///
/// OpenCV's function is not called: it truncates fractions in pixel blocks as wide as the processor's registers, and
/// rounds in the rest of a row. This function always truncates, in single precision and in the blocks' order of
/// operations.
pub(super) fn misread([red, green, blue]: [u8; 3]) -> [u8; 3] {
    let sixths = f32::from(blue) * (6.0 / 180.0);
    let (saturation, value) = (
        f32::from(green) * (1.0 / 255.0),
        f32::from(red) * (1.0 / 255.0),
    );
    let along = sixths.fract();
    let least = value * (1.0 - saturation);
    let falling = value * (-saturation).mul_add(along, 1.0);
    let rising = value * (-saturation).mul_add(1.0 - along, 1.0);
    let [r, g, b] = match sixths as u32 % 6 {
        0 => [value, rising, least],
        1 => [falling, value, least],
        2 => [least, value, rising],
        3 => [least, falling, value],
        4 => [rising, least, value],
        _ => [value, least, falling],
    };
    [b, g, r].map(|level| (level * 255.0) as u8)
}

/// Returns how far a colour is from grey, in 255 levels: three times its saturation, clamped.
///
/// Above a third a colour is plainly coloured. Without that limit, a cloth with a bright and a pale side, one fully
/// saturated and the other at 0.4, would be split in two instead of separated from the table. Saturation is relative to
/// the value, so in the dark it is camera noise; below a tenth of the value scale it counts as zero.
pub(super) fn saturation_level(color: [u8; 3]) -> u8 {
    const PLAIN: f64 = 1.0 / 3.0;
    const DARK: f64 = 0.1;
    let [_, saturation, value] = hsv(color);
    if value < DARK {
        return 0;
    }
    ((saturation / PLAIN).min(1.0) * 255.0 + 0.5) as u8
}

/// Returns the grey level of a colour as OpenCV's `cvtColor` computes it for 8-bit pictures.
///
/// Its weights are 0.299, 0.587 and 0.114 in units of 2^-15, rounded half up. OpenCV's function is not called
/// because its parameters differ between the releases that this crate builds with.
pub(super) fn gray_level([red, green, blue]: [u8; 3]) -> u8 {
    let [r, g, b] = [red, green, blue].map(u32::from);
    // The weights add up to 2^15, so white gives exactly 255.
    ((9_798 * r + 19_235 * g + 3_735 * b + (1 << 14)) >> 15) as u8
}
