//! Draws measured points and where they should be, so that small errors are visible.
//!
//! In: a picture, measured and expected places. Out: the same picture with a ring, a number and an arrow for each.

use super::numbers::draw_numbers;
use super::raster::Pen;
use super::{VisionError, check_size};
use image::RgbImage;

const BLACK: [u8; 3] = [0, 0, 0];
const RING: [u8; 3] = [255, 220, 0];
const ARROW: [u8; 3] = [255, 60, 60];

/// Draws a ring around each measured place, its number from 1, and an arrow towards where it should be.
///
/// Each entry is the measured place and the expected one, if any, `[column, row]`; arrows are `times` as long as the
/// error. Everything is clipped at the picture's edge.
pub fn draw_residuals(
    picture: &mut RgbImage,
    places: &[([f64; 2], Option<[f64; 2]>)],
    times: f64,
) -> Result<(), VisionError> {
    check_size(picture.width(), picture.height())?;
    let longest = picture.width().max(picture.height());
    let scale = f64::from((longest / 640).clamp(1, 4));
    // A black stroke below each coloured one makes it stand out on any table.
    let pens = |rgb| {
        [(BLACK, 2.0), (rgb, 0.0)].map(|(rgb, wider)| Pen {
            rgb,
            width_px: 1.5 * scale + wider,
        })
    };
    for (measured, expected) in places {
        let middle = measured.map(f64::floor);
        for pen in pens(RING) {
            pen.ring(picture, middle, 6.0 * scale);
        }
        let Some(expected) = expected else {
            continue;
        };
        let tip =
            [0, 1].map(|axis| (measured[axis] + times * (expected[axis] - measured[axis])).floor());
        for pen in pens(ARROW) {
            pen.arrow(picture, [middle, tip], [0.0; 2], 4.0 * scale);
        }
    }
    let measured: Vec<[f64; 2]> = places.iter().map(|(measured, _)| *measured).collect();
    draw_numbers(picture, &measured);
    Ok(())
}
