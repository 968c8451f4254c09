//! Strong corners of a grey picture: Harris and Stephens (1988), Shi and Tomasi (1994).
//!
//! In: an 8-bit picture and a [`CornerSearch`]. Out: pixels, strongest first. Prompts list corners in this order, so it
//! is that of OpenCV's `goodFeaturesToTrack` on a processor with fused multiply-add: each rounding below is one of
//! OpenCV's, and no other happens. Equal input gives equal bits on every machine. Rows stream through, so memory grows
//! with the width.

use crate::{CornerSearch, VisionError};
use fab_program::Response;
use image::GrayImage;
use std::collections::VecDeque;

/// Finds corners as `[x, y]` in whole pixels, strongest first; ties go to the lower, then the right one.
///
/// A corner is stronger than `quality` times the strongest, is no weaker than its eight neighbours, and is not in the
/// picture's outermost row or column. Weaker corners within `spacing_px` of a stronger one are left out.
pub fn strong_corners(
    picture: &GrayImage,
    search: &CornerSearch,
) -> Result<Vec<[f32; 2]>, VisionError> {
    let (mut peaks, strongest) = peaks(picture, search);
    let least = (f64::from(strongest) * search.quality) as f32;
    peaks.retain(|peak| peak.response > least);
    peaks.sort_unstable_by(|a, b| {
        (b.response.total_cmp(&a.response)).then((b.row, b.column).cmp(&(a.row, a.column)))
    });
    let mut corners: Vec<[f32; 2]> = Vec::new();
    for peak in peaks {
        let [x, y] = [peak.column, peak.row].map(|at| at as f32);
        // Whole numbers, so the squares are exact.
        let is_near = |corner: &[f32; 2]| {
            let [right, down] = [x - corner[0], y - corner[1]];
            f64::from(right * right + down * down) < search.spacing_px * search.spacing_px
        };
        if corners.len() < search.max as usize && !corners.iter().any(is_near) {
            corners.push([x, y]);
        }
    }
    Ok(corners)
}

/// A pixel whose response is positive and no less than its neighbours'.
struct Peak {
    response: f32,
    column: u32,
    row: u32,
}

/// Returns the peaks, and the largest response of all pixels.
fn peaks(picture: &GrayImage, search: &CornerSearch) -> (Vec<Peak>, f32) {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let mut responses = Responses::of(picture, search);
    let mut peaks = Vec::new();
    let mut strongest = f32::MIN;
    let mut rows: VecDeque<Vec<f32>> = VecDeque::new();
    for row in 0..height {
        let next = responses.row(row);
        strongest = next.iter().copied().fold(strongest, f32::max);
        rows.push_back(next);
        if rows.len() < 3 {
            continue;
        }
        for column in 1..width.saturating_sub(1) {
            let response = rows[1][column];
            let is_weaker = |line: &Vec<f32>| {
                let beside = &line[column - 1..=column + 1];
                beside.iter().all(|other| *other <= response)
            };
            if response > 0.0 && rows.iter().all(is_weaker) {
                peaks.push(Peak {
                    response,
                    column: column as u32,
                    row: row as u32 - 1,
                });
            }
        }
        rows.pop_front();
    }
    (peaks, strongest)
}

/// The responses of a picture, row by row.
struct Responses<'p> {
    picture: &'p GrayImage,
    /// Half the averaging square, without its middle.
    half: usize,
    response: Response,
    /// Sobel's smoothing weight of an outer pixel. It includes the scale to which OpenCV brings 8-bit gradients.
    weight: f32,
    /// The last rows of products of the gradients, xx, xy and yy, each summed along the averaging square's width, with
    /// the number of the row; at the row modulo their count.
    sums: Vec<(Option<usize>, Vec<[f64; 3]>)>,
}

impl<'p> Responses<'p> {
    fn of(picture: &'p GrayImage, search: &CornerSearch) -> Responses<'p> {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let block = search.block_px as usize;
        Responses {
            picture,
            half: block / 2,
            response: search.response,
            weight: (1.0 / (4.0 * block as f64 * 255.0)) as f32,
            sums: vec![(None, vec![[0.0; 3]; width]); block.min(height)],
        }
    }

    /// Returns the responses of a row.
    fn row(&mut self, row: usize) -> Vec<f32> {
        let (width, height) = (
            self.picture.width() as usize,
            self.picture.height() as usize,
        );
        let mut totals = vec![[0.0; 3]; width];
        for offset in 0..=2 * self.half {
            let source = mirrored(row as i64 + offset as i64 - self.half as i64, height);
            let slot = source % self.sums.len();
            if self.sums[slot].0 != Some(source) {
                self.sums[slot] = (Some(source), self.summed_products(source));
            }
            for (total, sum) in totals.iter_mut().zip(&self.sums[slot].1) {
                *total = [0, 1, 2].map(|plane| total[plane] + sum[plane]);
            }
        }
        let totals = totals.iter().map(|total| total.map(|total| total as f32));
        match self.response {
            Response::Harris { k } => totals.map(|total| harris(total, k as f32)).collect(),
            Response::ShiTomasi => totals.map(least_eigenvalue).collect(),
        }
    }

    /// Sums the products of a row's gradients along the averaging square's width.
    fn summed_products(&self, row: usize) -> Vec<[f64; 3]> {
        let (width, height) = (
            self.picture.width() as usize,
            self.picture.height() as usize,
        );
        let line = |offset: i64| {
            let first = mirrored(row as i64 + offset, height) * width;
            mirrored_ends(&self.picture.as_raw()[first..first + width], 1, |level| {
                f32::from(level)
            })
        };
        let [above, middle, below] = [-1, 0, 1].map(line);
        let lines = above
            .windows(3)
            .zip(middle.windows(3))
            .zip(below.windows(3));
        let products: Vec<[f32; 3]> = lines
            .map(|((above, middle), below)| {
                let [left, right] = [0, 2].map(|at| above[at] + below[at]);
                let along = (middle[2] - middle[0]) * (2.0 * self.weight);
                let x = fused(right - left, self.weight, along);
                let y = smoothed(below, self.weight) - smoothed(above, self.weight);
                [x * x, x * y, y * y]
            })
            .collect();
        let sum = |window: &[[f64; 3]]| {
            let add = |sum: [f64; 3], next: &[f64; 3]| [0, 1, 2].map(|at| sum[at] + next[at]);
            window.iter().fold([0.0; 3], add)
        };
        mirrored_ends(&products, self.half, |product| product.map(f64::from))
            .windows(2 * self.half + 1)
            .map(sum)
            .collect()
    }
}

/// Returns a line with some more values at both ends, mirrored at the outermost ones.
fn mirrored_ends<T: Copy, U>(line: &[T], n_more: usize, value: impl Fn(T) -> U) -> Vec<U> {
    let n_more = n_more as i64;
    let places = -n_more..line.len() as i64 + n_more;
    places
        .map(|at| value(line[mirrored(at, line.len())]))
        .collect()
}

/// Returns `a * b + c`, rounded once.
///
/// In `f64` the product of two `f32` is exact, and so is the sum of those here, whose bits lie close together: the only
/// rounding is the last one. `f32::mul_add` gives the same bits, but is a call into a library on plain x86-64.
fn fused(a: f32, b: f32, c: f32) -> f32 {
    (f64::from(a) * f64::from(b) + f64::from(c)) as f32
}

/// Smooths three neighbours of a row by 1, 2, 1.
fn smoothed(levels: &[f32], weight: f32) -> f32 {
    fused(
        levels[2],
        weight,
        fused(levels[1], 2.0 * weight, levels[0] * weight),
    )
}

fn harris([xx, xy, yy]: [f32; 3], k: f32) -> f32 {
    let trace = xx + yy;
    xx * yy - xy * xy - k * (trace * trace)
}
fn least_eigenvalue([xx, xy, yy]: [f32; 3]) -> f32 {
    let [a, c] = [xx * 0.5, yy * 0.5];
    let difference = a - c;
    (a + c) - (difference * difference + xy * xy).sqrt()
}

/// Returns the index that a picture of `length` has at `at` if it is mirrored at its outermost pixels.
fn mirrored(at: i64, length: usize) -> usize {
    let last = length as i64 - 1;
    if last == 0 {
        return 0;
    }
    let at = at.rem_euclid(2 * last);
    at.min(2 * last - at) as usize
}
