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
    if side_px <= 1 {
        return levels.to_vec();
    }
    let pixels = (0..height).flat_map(|row| (0..width).map(move |column| [column, row]));
    let index = |[column, row]: [u32; 2]| row as usize * width as usize + column as usize;
    let sums = Sums::of([width, height], |at| u64::from(levels[index(at)]));
    let average = |at| {
        let [sum, count] = sums.around(at, [side_px / 2; 2]);
        ((sum + count / 2) / count) as u8
    };
    pixels.map(average).collect()
}

/// Sums over rectangles of a picture.
struct Sums {
    size: [u32; 2],
    /// Of all pixels above and to the left of each corner between pixels, row by row.
    sums: Vec<u64>,
}

impl Sums {
    fn of([width, height]: [u32; 2], value: impl Fn([u32; 2]) -> u64) -> Sums {
        let mut sums = vec![0; width as usize + 1];
        for row in 0..height {
            let (above, mut along) = (sums.len() - width as usize - 1, 0);
            sums.push(0);
            for column in 0..width {
                along += value([column, row]);
                sums.push(sums[above + column as usize + 1] + along);
            }
        }
        Sums {
            size: [width, height],
            sums,
        }
    }

    /// Sums and counts the pixels in a square that reaches so many pixels up and left, and down and right.
    fn around(&self, at: [u32; 2], [before, behind]: [u32; 2]) -> [u64; 2] {
        let [left, top] = at.map(|at| at.saturating_sub(before));
        let [right, low] = [0, 1].map(|axis| (at[axis] + behind + 1).min(self.size[axis]));
        let sum = |column: u32, row: u32| {
            self.sums[row as usize * (self.size[0] as usize + 1) + column as usize]
        };
        let within = sum(right, low) + sum(left, top) - sum(right, top) - sum(left, low);
        [within, u64::from(right - left) * u64::from(low - top)]
    }
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
    // An even square has no middle; shrinking uses the mirrored square, so the two steps cancel.
    let (before, behind) = ((side_px - 1) / 2, side_px / 2);
    let size = [mask.width(), mask.height()];
    let sums = |mask: &Mask| {
        Sums::of(size, |[column, row]| {
            u64::from(mask.contains_at(column, row))
        })
    };
    let inside = sums(mask);
    let grown = Mask::from_fn(size[0], size[1], |column, row| {
        inside.around([column, row], [before, behind])[0] > 0
    });
    let inside = sums(&grown);
    Mask::from_fn(size[0], size[1], |column, row| {
        let [n_inside, n_all] = inside.around([column, row], [behind, before]);
        n_inside == n_all
    })
}

#[cfg(test)]
#[path = "split_tests.rs"]
mod tests;
