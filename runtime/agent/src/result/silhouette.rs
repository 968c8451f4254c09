//! Finds the cloth in a picture without depth.

use fab_picture::Mask;
use fab_picture::regions;
use image::RgbImage;

/// Finds the cloth of a subgoal picture: the largest patch without any of the border's colours.
///
/// An arrow drawn on the cloth counts as cloth. The mask is empty if everything has the border's colours.
pub fn silhouette(picture: &RgbImage) -> Mask {
    let table = regions::border_colours(&[picture]);
    let (width, height) = picture.dimensions();
    let other = Mask::from_fn(width, height, |column, row| {
        !regions::is_table(picture.get_pixel(column, row).0, &table)
    });
    let patches = regions::components(&other).into_iter();
    let cloth = patches.max_by_key(Vec::len).unwrap_or_default();
    Mask::from_pixels(width, height, &cloth)
}
