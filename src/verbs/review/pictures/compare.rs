//! Compares two pictures, pixel by pixel.
//!
//! In: two PNG files. Out: one picture of three panels, how many pixels differ, and where. Differences are drawn on a
//! pale grey copy of the new picture; pictures of different sizes are aligned at the top left. A file that is not a
//! picture gets an empty panel.

use super::Compared;
use fab_picture::png;
use image::{Rgb, RgbImage, imageops};
use std::path::Path;

/// Gap between panels, pixels.
const GAP_PX: u32 = 8;
const GAP: Rgb<u8> = Rgb([40, 40, 40]);
/// Background where a smaller picture has no pixels.
const NOTHING: Rgb<u8> = Rgb([160, 160, 160]);
/// Colour of pixels that differ; no task's cloth and no layer has it.
const CHANGED: Rgb<u8> = Rgb([255, 0, 160]);

/// Compares two PNG files, before and after; the message names them by their paths.
pub fn compare(files: [&[u8]; 2], paths: [&Path; 2]) -> Compared {
    let decoded = [0, 1].map(|side| png::decode(files[side], paths[side]));
    let (before, after) = match decoded {
        [Ok(before), Ok(after)] => (before, after),
        [before, after] => {
            let faults = [&before, &after].into_iter();
            let faults = faults.filter_map(|picture| picture.as_ref().err());
            let words: Vec<String> = faults.map(ToString::to_string).collect();
            return Compared {
                png: side_by_side(&[before.ok(), after.ok(), None]),
                words: words.join("\n"),
                ..Compared::default()
            };
        }
    };
    let (width, height) = larger(before.dimensions(), after.dimensions());
    let mut difference = RgbImage::new(width, height);
    let mut n_changed = 0;
    let mut bounds: Option<[u32; 4]> = None;
    for (column, row, pixel) in difference.enumerate_pixels_mut() {
        let old = before.get_pixel_checked(column, row);
        let new = after.get_pixel_checked(column, row);
        if old == new {
            *pixel = new.map_or(NOTHING, pale);
            continue;
        }
        *pixel = CHANGED;
        n_changed += 1;
        let [left, top, right, bottom] = bounds.unwrap_or([column, row, column, row]);
        bounds = Some([
            left.min(column),
            top.min(row),
            right.max(column),
            bottom.max(row),
        ]);
    }
    let words = in_words(n_changed, bounds, [before.dimensions(), after.dimensions()]);
    Compared {
        png: side_by_side(&[Some(before), Some(after), Some(difference)]),
        n_changed: Some(n_changed),
        bounds,
        words,
    }
}

fn larger(one: (u32, u32), other: (u32, u32)) -> (u32, u32) {
    (one.0.max(other.0), one.1.max(other.1))
}

/// Makes a PNG file of pictures beside each other; a missing picture leaves its panel empty.
fn side_by_side(shown: &[Option<RgbImage>; 3]) -> Option<Vec<u8>> {
    let sizes = shown.iter().flatten().map(RgbImage::dimensions);
    let (width, height) = sizes.reduce(larger)?;
    let mut sheet = RgbImage::from_pixel(3 * width + 2 * GAP_PX, height, GAP);
    for (panel, shown) in shown.iter().enumerate() {
        // Three panels of at most a few thousand pixels each.
        let left = i64::from(width + GAP_PX) * panel as i64;
        let mut whole = RgbImage::from_pixel(width, height, NOTHING);
        if let Some(shown) = shown {
            imageops::replace(&mut whole, shown, 0, 0);
        }
        imageops::replace(&mut sheet, &whole, left, 0);
    }
    Some(png::encode(&sheet))
}

fn in_words(n_changed: u64, bounds: Option<[u32; 4]>, sizes: [(u32, u32); 2]) -> String {
    let mut words = match bounds {
        None => "no pixel differs, only the bytes of the files".to_owned(),
        Some([left, top, right, bottom]) => {
            format!("{n_changed} pixels differ, columns {left} to {right}, rows {top} to {bottom}")
        }
    };
    let [before, after] = sizes;
    if before != after {
        words.push_str(&format!(
            "; the size was {} x {} and is {} x {}, what one lacks is grey",
            before.0, before.1, after.0, after.1
        ));
    }
    words
}

/// Returns a grey so light that a colour stands out.
fn pale(pixel: &Rgb<u8>) -> Rgb<u8> {
    let [red, green, blue] = pixel.0.map(u32::from);
    let grey = (299 * red + 587 * green + 114 * blue) / 1000;
    // At most 255, since each channel is.
    Rgb([(170 + grey / 3) as u8; 3])
}
