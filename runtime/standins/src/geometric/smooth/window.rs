//! The picture around a pick, turned so that the pull leads to the right.
//!
//! In: a [`View`], a pick and a direction. Out: a grid of cells, each with the shares of it that show the grasped face
//! and the other one, and with how much light is lost there. Its size is relative to the cloth's side, so neither the
//! picture's size nor the cloth's matters.

use super::view::{Face, View};
use fab_picture::hull::Point;

/// Cells along each side of the window.
pub const CELLS: usize = 24;

/// What each cell tells: the grasped face, the other face, the darkness.
pub const CHANNELS: usize = 3;

/// Length of each side, in sides of the cloth: a flat cloth fits in, whichever of its corners is picked.
const SPAN: f64 = 2.0;

/// How much of that lies ahead of the pick, in sides of the cloth. Most of the cloth lies behind; where a long pull ends is
/// among the features.
const AHEAD: f64 = 0.6;

/// Points that are sampled along each side of a cell.
const SAMPLES: usize = 6;

/// The cells of a window by channel, row and column; rows run from the left of the pull to its right.
pub type Window = [[[f32; CELLS]; CELLS]; CHANNELS];

/// Returns the window of a pick.
///
/// - `angle`: of the pull, radians, clockwise from the picture's right.
/// - `side`: of the flat cloth, pixels.
/// - `own`: the face that is grasped.
pub fn around(view: &View, pick: Point, angle: f64, side: f64, own: Face) -> Window {
    let (sin, cos) = angle.sin_cos();
    let step = SPAN / (CELLS * SAMPLES) as f64;
    let share = 1.0 / (SAMPLES * SAMPLES) as f32;
    let mut window = [[[0.0; CELLS]; CELLS]; CHANNELS];
    for down in 0..CELLS * SAMPLES {
        let beside = side * (step * (down as f64 + 0.5) - SPAN / 2.0);
        for across in 0..CELLS * SAMPLES {
            let ahead = side * (step * (across as f64 + 0.5) - (SPAN - AHEAD));
            let at = [
                pick[0] + ahead * cos - beside * sin,
                pick[1] + ahead * sin + beside * cos,
            ];
            let face = view.at(at);
            if face != Face::Table {
                let [row, column] = [down / SAMPLES, across / SAMPLES];
                window[usize::from(face != own)][row][column] += share;
                let dark = view.light(at).map_or(0.0, |light| 1.0 - light);
                window[2][row][column] += share * dark as f32;
            }
        }
    }
    window
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use image::{Rgb, RgbImage};

    #[test]
    fn the_window_of_a_mirrored_picture_has_its_rows_reversed() {
        let picture = |is_mirrored: bool| {
            RgbImage::from_fn(360, 360, |column, row| {
                let row = if is_mirrored { 359 - row } else { row };
                match (column, row) {
                    (130..200, 121..180) => Rgb([255, 113, 0]),
                    (150..212, 180..235) => Rgb([250, 145, 205]),
                    _ => Rgb([213, 213, 216]),
                }
            })
        };
        let window = |is_mirrored: bool| {
            let mut png = std::io::Cursor::new(Vec::new());
            let format = image::ImageFormat::Png;
            picture(is_mirrored).write_to(&mut png, format).unwrap();
            let view = View::decode(&png.into_inner()).unwrap();
            let row = if is_mirrored { 360.0 - 122.3 } else { 122.3 };
            let angle = if is_mirrored { -0.4 } else { 0.4 };
            around(&view, [131.2, row], angle, 110.0, Face::Top)
        };
        let (plain, mirrored) = (window(false), window(true));
        let cells =
            |window: &Window, channel: usize| window[channel].as_flattened().iter().sum::<f32>();
        assert!(cells(&plain, 0) > 10.0 && cells(&plain, 1) > 10.0);
        for (rows, others) in plain.iter().zip(&mirrored) {
            for (row, other) in rows.iter().zip(others.iter().rev()) {
                for (cell, other) in row.iter().zip(other) {
                    assert!((cell - other).abs() < 0.1, "{cell} and {other}");
                }
            }
        }
    }
}
