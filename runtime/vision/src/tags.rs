//! Printed tags: AprilTags of the family 36h11, found by the detector of their authors.
//!
//! In: a picture. Out: each tag's number and the pixel of its middle, to a tenth of a pixel. Corners are left out: which
//! of them is the upper left one depends on the program that printed the tag (OpenCV turns tags by half a turn). What a
//! tag stands for is decided elsewhere.

use super::VisionError;
use fab_picture::Tag;
use image::RgbImage;

/// Finds tags, by number.
#[cfg(not(feature = "tags"))]
pub fn tags(_: &RgbImage) -> Result<Vec<Tag>, VisionError> {
    let how =
        "this build finds no tags; `cargo install --path . --features tags` installs one that does";
    Err(VisionError(how.to_owned()))
}

/// Finds tags, by number.
#[cfg(feature = "tags")]
pub fn tags(picture: &RgbImage) -> Result<Vec<Tag>, VisionError> {
    use apriltag::{Detector, Image, families::Tag36h11};
    // A smaller side shows no tag; below 4 pixels the detector reads outside of the picture.
    const LEAST_SIDE_PX: u32 = 16;
    // How many wrong cells of a tag are corrected; with more, other things look like tags.
    const CORRECTED: usize = 1;
    let (width, height) = picture.dimensions();
    super::check_size(width, height)?;
    if width.min(height) < LEAST_SIDE_PX {
        return Ok(Vec::new());
    }
    let failed =
        |error: apriltag::Error| VisionError(format!("the detector of tags failed: {error}"));
    let (grey, width) = (image::imageops::grayscale(picture), width as usize);
    let mut image = Image::zeros_with_alignment(width, height as usize, 1).map_err(failed)?;
    let stride = image.stride();
    let rows = image.as_slice_mut().chunks_mut(stride);
    for (to, from) in rows.zip(grey.as_raw().chunks(width)) {
        to[..width].copy_from_slice(from);
    }
    let builder = Detector::builder().add_family_bits(Tag36h11::default(), CORRECTED);
    let mut detector = builder.build().map_err(failed)?;
    detector.set_thread_number(1);
    // At full resolution: calibrations need the place more than speed.
    detector.set_decimation(1.0);
    let found = detector.detect(&image).into_iter();
    let mut tags: Vec<Tag> = found
        .map(|found| Tag {
            id: found.id(),
            middle_px: found.center(),
        })
        .collect();
    tags.sort_by_key(|tag| tag.id);
    Ok(tags)
}
