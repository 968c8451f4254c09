//! Lays a picture before, after, and their difference side by side.
//!
//! In: two PNG files. Out: one picture of three panels, how many pixels differ, and where. What differs is drawn on a
//! pale grey copy of the picture after; pictures of two sizes are laid at the top left of the larger one.

use image::{Rgb, RgbImage, imageops};
use runtime::picture::{self, PictureError};
use std::path::Path;

/// Between panels, pixels.
const GAP_PX: u32 = 8;
const GAP: Rgb<u8> = Rgb([40, 40, 40]);
/// Where a smaller picture has nothing.
const NOTHING: Rgb<u8> = Rgb([160, 160, 160]);
/// A pixel that differs; no cloth of a task and no layer has this colour.
const CHANGED: Rgb<u8> = Rgb([255, 0, 160]);

/// What differs between two pictures.
pub struct Compared {
    /// The three panels.
    pub sheet: RgbImage,
    /// How many pixels differ.
    pub n_changed: u64,
    /// Leftmost column, top row, rightmost column and bottom row of those, pixels.
    pub bounds: Option<[u32; 4]>,
    /// Width and height before and after, pixels.
    pub sizes: [(u32, u32); 2],
}

/// Compares two PNG files; `path` names them in errors.
pub fn compare(before: &[u8], after: &[u8], path: &Path) -> Result<Compared, PictureError> {
    let before = picture::decode(before, path)?;
    let after = picture::decode(after, path)?;
    let width = before.width().max(after.width());
    let height = before.height().max(after.height());
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
    let sizes = [before.dimensions(), after.dimensions()];
    let mut sheet = RgbImage::from_pixel(3 * width + 2 * GAP_PX, height, GAP);
    for (panel, shown) in [before, after, difference].iter().enumerate() {
        // Three panels of at most some thousand pixels each.
        let left = i64::from(width + GAP_PX) * panel as i64;
        let mut whole = RgbImage::from_pixel(width, height, NOTHING);
        imageops::replace(&mut whole, shown, 0, 0);
        imageops::replace(&mut sheet, &whole, left, 0);
    }
    Ok(Compared {
        sheet,
        n_changed,
        bounds,
        sizes,
    })
}

impl Compared {
    /// Says what differs.
    pub fn in_words(&self) -> String {
        let mut words = match self.bounds {
            None => "no pixel differs, only the bytes of the files".to_owned(),
            Some([left, top, right, bottom]) => format!(
                "{} pixels differ, columns {left} to {right}, rows {top} to {bottom}",
                self.n_changed
            ),
        };
        let [before, after] = self.sizes;
        if before != after {
            words.push_str(&format!(
                "; the size was {} x {} and is {} x {}, what one lacks is grey",
                before.0, before.1, after.0, after.1
            ));
        }
        words
    }
}

/// Returns a grey that is light enough for a colour to stand out.
fn pale(pixel: &Rgb<u8>) -> Rgb<u8> {
    let [red, green, blue] = pixel.0.map(u32::from);
    let grey = (299 * red + 587 * green + 114 * blue) / 1000;
    // At most 255, since each channel is.
    Rgb([(170 + grey / 3) as u8; 3])
}
