//! Splits a picture into regions: the table by its colours, patches by connectivity.
//!
//! In: pictures. Out: colours and sets of pixels. Nothing here distinguishes cloth from arrow.

use crate::Mask;
use fab_program::PixelPoint;
use image::RgbImage;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Connected pixels.
pub type Patch = Vec<PixelPoint>;

/// Splits a set into its connected patches; pixels that touch at a corner are connected.
///
/// The patches are in the order of their topmost, then leftmost pixel.
pub fn components(set: &Mask) -> Vec<Patch> {
    split(set, |_, _| true)
}

/// Likewise, but pixels that touch only at a corner are not connected.
pub fn patches(set: &Mask) -> Vec<Patch> {
    split(set, |right, down| right == 0 || down == 0)
}

/// Returns the holes of a patch, in the order of their topmost, then leftmost pixel.
///
/// Pixels of the patch that touch only at a corner still close it.
pub fn holes(patch: &Patch) -> Vec<Patch> {
    let span = |of: fn(&PixelPoint) -> i32| {
        let (least, most) = (patch.iter().map(of).min(), patch.iter().map(of).max());
        Some((least? - 1, (most? - least?) as u32 + 3))
    };
    let (Some((left, width)), Some((top, height))) = (span(|at| at.u), span(|at| at.v)) else {
        return Vec::new();
    };
    // One pixel of margin all round connects everything outside.
    let moved = patch
        .iter()
        .map(|at| PixelPoint::new(at.u - left, at.v - top));
    let own = Mask::from_pixels(width, height, &moved.collect::<Patch>());
    let gaps = Mask::from_fn(own.width(), own.height(), |column, row| {
        !own.contains_at(column, row)
    });
    let mut holes = patches(&gaps);
    // The outside comes first, because it holds the top left pixel.
    holes.remove(0);
    for at in holes.iter_mut().flatten() {
        *at = PixelPoint::new(at.u + left, at.v + top);
    }
    holes
}

/// Splits a set into patches; `connects` decides which steps to a neighbour (right, down) connect two pixels.
fn split(set: &Mask, connects: fn(i32, i32) -> bool) -> Vec<Patch> {
    let around = (-1..=1).flat_map(|down| (-1..=1).map(move |right| (right, down)));
    let steps: Vec<(i32, i32)> = around
        .filter(|&(right, down)| connects(right, down))
        .collect();
    let mut seen = vec![false; set.width() as usize * set.height() as usize];
    let mut is_new = |at: PixelPoint| {
        let index = set.index(at).filter(|_| set.contains(at));
        index.is_some_and(|index| !std::mem::replace(&mut seen[index], true))
    };
    let mut patches = Vec::new();
    for start in set.pixels() {
        if !is_new(start) {
            continue;
        }
        let mut patch = vec![start];
        let mut next = 0;
        while let Some(&at) = patch.get(next) {
            next += 1;
            let near = steps
                .iter()
                .map(|(right, down)| PixelPoint::new(at.u + right, at.v + down));
            patch.extend(near.filter(|near| is_new(*near)));
        }
        patches.push(patch);
    }
    patches
}

/// Width of the border assumed to show only table, pixels.
const BORDER_PX: u32 = 2;

/// Smallest share of the border that a table colour takes up, one part in this many.
const LEAST_SHARE: usize = 33;

/// Returns the colours of the pictures' borders, red, green, blue: one for a plain table, more for a checkered one.
pub fn border_colours(pictures: &[&RgbImage]) -> Vec<[f64; 3]> {
    // Bins of 16 levels per channel.
    let mut bins: BTreeMap<[u8; 3], (Vector3<f64>, usize)> = BTreeMap::new();
    let mut n_pixels = 0;
    for picture in pictures {
        let (width, height) = picture.dimensions();
        let on_border = |at: u32, side: u32| at < BORDER_PX || at + BORDER_PX >= side;
        let border = picture
            .enumerate_pixels()
            .filter(|&(column, row, _)| on_border(column, width) || on_border(row, height));
        for (_, _, pixel) in border {
            let (sum, count) = bins.entry(pixel.0.map(|level| level / 16)).or_default();
            *sum += Vector3::from(pixel.0).map(f64::from);
            *count += 1;
            n_pixels += 1;
        }
    }
    let frequent = bins
        .into_values()
        .filter(|&(_, count)| count * LEAST_SHARE >= n_pixels);
    frequent
        .map(|(sum, count)| (sum / count as f64).into())
        .collect()
}

/// How dark and how bright a table colour may appear, as factors. A fold's soft shadow dims the recorded tables to 0.70
/// of their brightness.
const SHADING: std::ops::RangeInclusive<f64> = 0.65..=1.1;

/// How far a shaded table colour may deviate, 8-bit levels; the recorded tables deviate by at most 2.
const TINT: f64 = 24.0;

/// Returns whether a colour is one of the table's, possibly in shadow: a shadow dims a colour but does not tint it.
pub fn is_table(rgb: [u8; 3], table: &[[f64; 3]]) -> bool {
    let rgb = Vector3::from(rgb).map(f64::from);
    table.iter().any(|colour| {
        let colour = Vector3::from(*colour);
        let factor = rgb.dot(&colour) / colour.norm_squared().max(1.0);
        let factor = factor.clamp(*SHADING.start(), *SHADING.end());
        (rgb - factor * colour).norm() <= TINT
    })
}
