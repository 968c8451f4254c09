//! Masks by splitting a picture in two: a cloth and a table of another brightness or colour.
//!
//! In: an RGB picture. Out: a [`Mask`]. The threshold is the level that separates the two sides best (Otsu 1979). It is
//! found in the picture itself, so no number depends on the lighting. Nothing here knows which side is the cloth.

use super::color::{gray_level, saturation_level};
use fab_picture::Mask;
use fab_program::{Channel, Side};
use image::RgbImage;

/// Keeps the pixels on one side of the best level.
///
/// - `blur_px`: side of the square for averaging first; 0 and 1 change nothing.
/// - `contrast`: least distance between the means of the sides, 0 to 1; a smaller one gives an empty mask.
pub fn split_mask(rgb: &RgbImage, of: Channel, keep: Side, blur_px: u32, contrast: f64) -> Mask {
    let (width, height) = rgb.dimensions();
    let levels = blurred(&levels(rgb, of), [width, height], blur_px);
    let at = |column: u32, row: u32| levels[row as usize * width as usize + column as usize];
    match split(&levels) {
        Some(split) if split.contrast() >= contrast => {
            Mask::from_fn(width, height, |column, row| match keep {
                Side::Low => at(column, row) <= split.level,
                Side::High => at(column, row) > split.level,
            })
        }
        _ => Mask::from_fn(width, height, |_, _| false),
    }
}

/// Returns the distance between the means of a picture's two sides, 0 to 1; `None` if all pixels are equal.
pub fn contrast_of(rgb: &RgbImage, of: Channel, blur_px: u32) -> Option<f64> {
    let levels = blurred(&levels(rgb, of), rgb.dimensions().into(), blur_px);
    split(&levels).map(|split| split.contrast())
}

fn levels(rgb: &RgbImage, of: Channel) -> Vec<u8> {
    let level = match of {
        Channel::Brightness => gray_level,
        Channel::Saturation => saturation_level,
    };
    rgb.pixels().map(|pixel| level(pixel.0)).collect()
}

/// Averages over a square around each pixel, clipped at the picture's edge.
fn blurred(levels: &[u8], [width, height]: [u32; 2], side_px: u32) -> Vec<u8> {
    if side_px <= 1 || levels.is_empty() {
        return levels.to_vec();
    }
    let (width, height) = (width as usize, height as usize);
    // Sums of all levels above and to the left.
    let mut sums = vec![0_u64; (width + 1) * (height + 1)];
    for row in 0..height {
        let mut along = 0_u64;
        for column in 0..width {
            along += u64::from(levels[row * width + column]);
            sums[(row + 1) * (width + 1) + column + 1] =
                sums[row * (width + 1) + column + 1] + along;
        }
    }
    let half = (side_px / 2) as usize;
    let range = |at: usize, side: usize| (at.saturating_sub(half), (at + half + 1).min(side));
    let mut averages = Vec::with_capacity(levels.len());
    for row in 0..height {
        let (top, low) = range(row, height);
        for column in 0..width {
            let (left, right) = range(column, width);
            let sum = sums[low * (width + 1) + right] + sums[top * (width + 1) + left]
                - sums[top * (width + 1) + right]
                - sums[low * (width + 1) + left];
            let count = ((low - top) * (right - left)) as u64;
            averages.push(((sum + count / 2) / count) as u8);
        }
    }
    averages
}

/// A threshold between two sides.
struct Split {
    /// The highest level of the low side.
    level: u8,
    /// The mean levels of both sides.
    means: [f64; 2],
}

impl Split {
    fn contrast(&self) -> f64 {
        (self.means[1] - self.means[0]) / 255.0
    }
}

/// Finds the level with the largest variance between both sides; ties go to the lowest. `None` if all levels are equal.
fn split(levels: &[u8]) -> Option<Split> {
    let mut counts = [0_u64; 256];
    for level in levels {
        counts[usize::from(*level)] += 1;
    }
    let weighed = |(level, count): (usize, &u64)| level as u64 * count;
    let (n_all, sum_all) = (
        levels.len() as u64,
        counts.iter().enumerate().map(weighed).sum::<u64>(),
    );
    let (mut n_low, mut sum_low) = (0_u64, 0_u64);
    let mut best: Option<(f64, Split)> = None;
    for (level, count) in counts.iter().enumerate().take(255) {
        n_low += count;
        sum_low += weighed((level, count));
        let n_high = n_all - n_low;
        if n_low == 0 || n_high == 0 {
            continue;
        }
        let means = [
            sum_low as f64 / n_low as f64,
            (sum_all - sum_low) as f64 / n_high as f64,
        ];
        let between = n_low as f64 * n_high as f64 * (means[1] - means[0]).powi(2);
        if best.as_ref().is_none_or(|(most, _)| between > *most) {
            let level = level as u8;
            best = Some((between, Split { level, means }));
        }
    }
    best.map(|(_, split)| split)
}

/// Fills the gaps of a mask: grows it by a square, and shrinks it by the same.
///
/// Every pixel of the mask stays in it. The area beyond the picture's edge fills nothing.
///
/// - `side_px`: side of the square; 0 and 1 change nothing.
pub fn closed(mask: &Mask, side_px: u32) -> Mask {
    let side_px = side_px.max(1);
    // An even square has no middle; eroding uses the mirrored square, so the two steps cancel.
    let (before, behind) = ((side_px - 1) / 2, side_px / 2);
    let grown = swept(mask, [before, behind], |n_inside, _| n_inside > 0);
    swept(&grown, [behind, before], |n_inside, n_all| {
        n_inside == n_all
    })
}

/// Decides each pixel by how many of its neighbours are inside and how many there are, along rows and then columns.
fn swept(mask: &Mask, [before, behind]: [u32; 2], decide: fn(u32, u32) -> bool) -> Mask {
    let (width, height) = (mask.width(), mask.height());
    let along_rows = line_by_line([width, height], [before, behind], decide, |column, row| {
        mask.contains_at(column, row)
    });
    let at = |column: u32, row: u32| along_rows[row as usize * width as usize + column as usize];
    let along_columns = line_by_line([height, width], [before, behind], decide, |row, column| {
        at(column, row)
    });
    Mask::from_fn(width, height, |column, row| {
        along_columns[column as usize * height as usize + row as usize]
    })
}

/// Does one such pass along `count` lines of `length` each: `[count * length]`, line by line.
fn line_by_line(
    [length, count]: [u32; 2],
    [before, behind]: [u32; 2],
    decide: fn(u32, u32) -> bool,
    is_inside: impl Fn(u32, u32) -> bool,
) -> Vec<bool> {
    let mut decided = Vec::with_capacity(length as usize * count as usize);
    for line in 0..count {
        let mut sums = vec![0_u32];
        for at in 0..length {
            sums.push(sums[at as usize] + u32::from(is_inside(at, line)));
        }
        for at in 0..length {
            let first = at.saturating_sub(before);
            let end = (at + behind + 1).min(length);
            decided.push(decide(
                sums[end as usize] - sums[first as usize],
                end - first,
            ));
        }
    }
    decided
}

#[cfg(test)]
#[path = "split_tests.rs"]
mod tests;
