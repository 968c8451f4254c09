//! Draws measured points and where they should be, so that small errors are visible.
//!
//! In: a picture, measured and expected places. Out: the same picture with a ring, a number and an arrow for each.

use super::VisionError;
use super::draw::{arrow, canvas, ring};
use super::numbers::draw_numbers;
use image::RgbImage;
use opencv::core::Point;

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
    let longest = picture.width().max(picture.height());
    let scale = (longest / 640).clamp(1, 4) as i32;
    let measured: Vec<[f64; 2]> = places.iter().map(|(measured, _)| *measured).collect();
    {
        let mut canvas = canvas(picture)?;
        for (measured, expected) in places {
            let Some(middle) = pixel(*measured) else {
                continue;
            };
            // A black stroke below each coloured one makes it stand out on any table.
            for (rgb, wider) in [(BLACK, 3), (RING, 1)] {
                ring(&mut canvas, middle, 6 * scale, scale + wider, rgb)?;
            }
            let tip = expected.and_then(|[u, v]| {
                pixel([
                    measured[0] + times * (u - measured[0]),
                    measured[1] + times * (v - measured[1]),
                ])
            });
            for (rgb, wider) in [(BLACK, 3), (ARROW, 1)] {
                if let Some(tip) = tip {
                    arrow(&mut canvas, middle, tip, scale + wider, rgb)?;
                }
            }
        }
    }
    draw_numbers(picture, &measured);
    Ok(())
}

/// Returns the pixel that holds a place; `None` if the place is not finite.
fn pixel([u, v]: [f64; 2]) -> Option<Point> {
    let far = 16_384.0;
    let near = |value: f64| value.clamp(-far, far).floor() as i32;
    (u.is_finite() && v.is_finite()).then(|| Point::new(near(u), near(v)))
}
