//! Finds the cloth in a picture without depth.

use fab_picture::Mask;
use fab_picture::regions::{self, Patch};
use image::RgbImage;

/// Finds the cloth of a subgoal picture: the largest patch without any of the border's colours.
///
/// Gaps of up to two pixels in it count as cloth: where a face of one colour meets another, pixels of both may be as grey as
/// the table. An arrow drawn on the cloth counts as cloth, too. The mask is empty if everything has the border's colours.
pub fn silhouette(picture: &RgbImage) -> Mask {
    let table = regions::border_colours(&[picture]);
    let (width, height) = picture.dimensions();
    let is_other = |column, row| !regions::is_table(picture.get_pixel(column, row).0, &table);
    let other = Mask::from_fn(width, height, is_other);
    let grown = Mask::from_fn(width, height, |column, row| {
        around(&other, column, row).any(|is_inside| is_inside)
    });
    // Specks grow most, so patches are compared by what they were.
    let own_px = |patch: &Patch| patch.iter().filter(|at| other.contains(**at)).count();
    let patches = regions::components(&grown).into_iter();
    let cloth = Mask::from_pixels(
        width,
        height,
        &patches.max_by_key(own_px).unwrap_or_default(),
    );
    Mask::from_fn(width, height, |column, row| {
        around(&cloth, column, row).all(|is_inside| is_inside)
    })
}

/// Tells which of a pixel and those around it are in a mask; what is beyond the picture is left out.
fn around(mask: &Mask, column: u32, row: u32) -> impl Iterator<Item = bool> {
    let near = |at: u32, side: u32| at.saturating_sub(1)..=(at + 1).min(side - 1);
    let columns = near(column, mask.width());
    near(row, mask.height()).flat_map(move |row| {
        columns
            .clone()
            .map(move |column| mask.contains_at(column, row))
    })
}
