//! Pixels of a depth picture without a reading: stereo cameras leave them everywhere, also on the cloth.
//!
//! In: readings of a camera. Out: the same with small holes closed, and words on how many there were. Large holes stay:
//! what is there is not known.

use crate::regions;
use crate::{DepthImage, Mask, has_reading};
use fab_program::PixelPoint;

/// The largest hole that is closed, as a share of the picture: 50 pixels of 224 by 224.
const LARGEST_HOLE: f64 = 0.001;

/// Closes the small holes of a depth picture; says what it did if there were any.
///
/// A pixel gets the lower median of the readings around it; the mean of a near and a far reading would lie on no surface.
/// A picture without readings, or without holes, stays as it is.
pub fn closed(depth_m: &DepthImage) -> (DepthImage, Option<String>) {
    let (width, height) = depth_m.dimensions();
    let missing = Mask::from_fn(width, height, |column, row| {
        !has_reading(depth_m.get_pixel(column, row).0[0])
    });
    let all_px = width as usize * height as usize;
    let mut closed = depth_m.clone();
    if missing.is_empty() || missing.area_px() == all_px {
        return (closed, None);
    }
    let largest_px = (LARGEST_HOLE * all_px as f64).ceil() as usize;
    let mut n_closed = 0;
    for mut hole in regions::patches(&missing) {
        if hole.len() > largest_px {
            continue;
        }
        n_closed += hole.len();
        while !hole.is_empty() {
            let around = |at: PixelPoint| (at, median_around(&closed, at.u as u32, at.v as u32));
            let found: Vec<_> = hole.drain(..).map(around).collect();
            for (at, reading) in found {
                match reading {
                    Some(reading) => closed.get_pixel_mut(at.u as u32, at.v as u32).0[0] = reading,
                    None => hole.push(at),
                }
            }
        }
    }
    let n_missing = missing.area_px();
    let left = match n_missing - n_closed {
        0 => String::new(),
        left => format!(", and {left} are left, near which corners may be false"),
    };
    let note = format!(
        "{n_missing} of {all_px} pixels of the depth picture have no reading; {n_closed} of them, in holes of at most \
         {largest_px}, are filled from the readings around them{left}"
    );
    (closed, Some(note))
}

/// Returns the lower median of the readings beside a pixel.
fn median_around(depth_m: &DepthImage, column: u32, row: u32) -> Option<f32> {
    let near = |at: u32| at.saturating_sub(1)..=at + 1;
    let pixels = near(row).flat_map(|row| near(column).map(move |column| (column, row)));
    let mut readings: Vec<f32> = pixels
        .filter_map(|(column, row)| Some(depth_m.get_pixel_checked(column, row)?.0[0]))
        .filter(|reading| has_reading(*reading))
        .collect();
    readings.sort_by(f32::total_cmp);
    readings.get(readings.len().checked_sub(1)? / 2).copied()
}

#[cfg(test)]
mod tests;
