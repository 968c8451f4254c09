//! Shows how a picture changed: before, after and the difference as one file, and the difference in words.
//!
//! In: a pending picture. Out: a PNG file of three panels in the named folder, whose path is reported. Differences are
//! drawn on a pale grey copy of the new picture; pictures of different sizes are aligned at the top left. The authoring
//! tool cannot draw.

use super::find::Pending;
use crate::exit::Failure;
use serde::Serialize;
use std::path::{Path, PathBuf};

#[cfg(feature = "runtime")]
use {
    crate::io::write_file,
    fab_picture::png,
    image::{Rgb, RgbImage, imageops},
    std::fs,
};

/// The difference between two pictures.
#[derive(Default, Serialize)]
pub struct Comparison {
    /// Before, after and difference side by side, as a PNG file; `None` if nothing can be drawn.
    pub path: Option<PathBuf>,
    /// How many pixels differ, if known.
    pub changed_pixels: Option<u64>,
    /// The difference in words.
    pub words: String,
}

impl Comparison {
    /// Describes the difference, and names the file that shows it.
    pub fn in_words(&self) -> String {
        match &self.path {
            Some(path) => format!(
                "{}\nbefore, after and difference: {}",
                self.words,
                path.display()
            ),
            None => self.words.clone(),
        }
    }

    fn without_drawing(words: String) -> Comparison {
        Comparison {
            words,
            ..Comparison::default()
        }
    }
}

/// Returns that pictures differ: the authoring tool cannot say more.
#[cfg(not(feature = "runtime"))]
pub fn compare(_: &Pending, _: &str, _: &Path) -> Result<Comparison, Failure> {
    let words = "the pictures differ; this build of fabc cannot draw them";
    Ok(Comparison::without_drawing(words.to_owned()))
}

/// Gap between panels, pixels.
#[cfg(feature = "runtime")]
const GAP_PX: u32 = 8;
#[cfg(feature = "runtime")]
const GAP: Rgb<u8> = Rgb([40, 40, 40]);
/// Background where a smaller picture has no pixels.
#[cfg(feature = "runtime")]
const NOTHING: Rgb<u8> = Rgb([160, 160, 160]);
/// Colour of pixels that differ; no task's cloth and no layer has it.
#[cfg(feature = "runtime")]
const CHANGED: Rgb<u8> = Rgb([255, 0, 160]);

/// Draws the pictures of a pending snapshot as `NAME.png` in a folder; fails if the file cannot be written.
#[cfg(feature = "runtime")]
pub fn compare(pending: &Pending, name: &str, folder: &Path) -> Result<Comparison, Failure> {
    let Some([before, after]) = pending.pictures() else {
        let words = "a text became a picture, or a picture a text".to_owned();
        return Ok(Comparison::without_drawing(words));
    };
    let accepted = pending.path.with_extension("png");
    let proposed = pending.path.with_added_extension("png");
    let decoded =
        [(before, &accepted), (after, &proposed)].map(|(png, path)| png::decode(png, path));
    let [before, after] = match decoded {
        [Ok(before), Ok(after)] => [before, after],
        [Err(error), _] | [_, Err(error)] => {
            return Ok(Comparison::without_drawing(error.to_string()));
        }
    };
    let (difference, n_changed) = difference(&before, &after);
    let mut words = match n_changed {
        0 => "no pixel differs, only the bytes of the files".to_owned(),
        count => format!("{count} pixels differ"),
    };
    let [old, new] = [before.dimensions(), after.dimensions()];
    if old != new {
        words.push_str(&format!(
            "; the size was {} x {} and is {} x {}, what one lacks is grey",
            old.0, old.1, new.0, new.1
        ));
    }
    fs::create_dir_all(folder).map_err(|error| Failure::unwritable(folder, error))?;
    let path = folder.join(format!("{name}.png"));
    write_file(
        &path,
        &png::encode(&side_by_side([&before, &after, &difference])),
    )?;
    Ok(Comparison {
        path: Some(path),
        changed_pixels: Some(n_changed),
        words,
    })
}

/// Marks the pixels that differ, and counts them.
#[cfg(feature = "runtime")]
fn difference(before: &RgbImage, after: &RgbImage) -> (RgbImage, u64) {
    let width = before.width().max(after.width());
    let height = before.height().max(after.height());
    let mut n_changed = 0;
    let difference = RgbImage::from_fn(width, height, |column, row| {
        let old = before.get_pixel_checked(column, row);
        let new = after.get_pixel_checked(column, row);
        if old == new {
            return new.map_or(NOTHING, pale);
        }
        n_changed += 1;
        CHANGED
    });
    (difference, n_changed)
}

/// Lays pictures beside each other; the last is as large as the largest.
#[cfg(feature = "runtime")]
fn side_by_side(shown: [&RgbImage; 3]) -> RgbImage {
    let (width, height) = shown[2].dimensions();
    let mut sheet = RgbImage::from_pixel(3 * width + 2 * GAP_PX, height, GAP);
    for (shown, panel) in shown.into_iter().zip(0..) {
        let left = i64::from(width + GAP_PX) * panel;
        let background = RgbImage::from_pixel(width, height, NOTHING);
        imageops::replace(&mut sheet, &background, left, 0);
        imageops::replace(&mut sheet, shown, left, 0);
    }
    sheet
}

/// Returns a grey so light that a colour stands out.
#[cfg(feature = "runtime")]
fn pale(pixel: &Rgb<u8>) -> Rgb<u8> {
    let [red, green, blue] = pixel.0.map(u32::from);
    let grey = (299 * red + 587 * green + 114 * blue) / 1000;
    // At most 255, since each channel is.
    Rgb([(170 + grey / 3) as u8; 3])
}
