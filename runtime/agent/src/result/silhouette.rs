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
    let grown = Mask::from_fn(width, height, |column, row| other.is_within(1, column, row));
    // Specks grow most, so patches are compared by what they were.
    let own_px = |patch: &Patch| patch.iter().filter(|at| other.contains(**at)).count();
    let patches = regions::components(&grown).into_iter();
    let cloth = Mask::from_pixels(
        width,
        height,
        &patches.max_by_key(own_px).unwrap_or_default(),
    );
    let rest = Mask::from_fn(width, height, |column, row| !cloth.contains_at(column, row));
    Mask::from_fn(width, height, |column, row| !rest.is_within(1, column, row))
}
