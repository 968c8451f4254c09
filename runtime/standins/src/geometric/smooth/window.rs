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

/// Length of each side, in sides of the cloth.
const SPAN: f64 = 2.0;

/// How much of it lies ahead of the pick.
const AHEAD: f64 = 0.6;

/// Points that are looked at along each side of a cell.
const LOOKS: usize = 6;

/// The cells of a window by channel, row and column; rows run from the left of the pull to its right.
pub type Window = [[[f32; CELLS]; CELLS]; CHANNELS];

/// Returns the window of a pick.
///
/// - `angle`: of the pull, radians, clockwise from the picture's right.
/// - `side`: of the flat cloth, pixels.
/// - `own`: the face that is grasped.
pub fn around(view: &View, pick: Point, angle: f64, side: f64, own: Face) -> Window {
    let (sin, cos) = angle.sin_cos();
    let step = SPAN / (CELLS * LOOKS) as f64;
    let share = 1.0 / (LOOKS * LOOKS) as f32;
    let mut window = [[[0.0; CELLS]; CELLS]; CHANNELS];
    for down in 0..CELLS * LOOKS {
        let beside = side * (step * (down as f64 + 0.5) - SPAN / 2.0);
        for across in 0..CELLS * LOOKS {
            let ahead = side * (step * (across as f64 + 0.5) - (SPAN - AHEAD));
            let at = [
                pick[0] + ahead * cos - beside * sin,
                pick[1] + ahead * sin + beside * cos,
            ];
            let face = view.at(at);
            if face != Face::Table {
                let [row, column] = [down / LOOKS, across / LOOKS];
                window[usize::from(face != own)][row][column] += share;
                let dark = view.light(at).map_or(0.0, |light| 1.0 - light);
                window[2][row][column] += share * dark as f32;
            }
        }
    }
    window
}
