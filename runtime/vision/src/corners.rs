//! Corners of the cloth in an observation.
//!
//! In: a depth image and a picture, the cloth's mask, a [`CornerSearch`]. Out: pixels of the camera image, strongest
//! corner first. The detector looks at an 8-bit picture of the cloth on black (protocol, sections 4 and 6); [`corners`]
//! makes that picture, [`corners_of_gray`] is the bare detector.

use super::primitives::chosen;
use super::sight::detector_picture;
use super::{MAX_SIDE_PX, VisionError, bounding_box, check_size};
use fab_picture::mask_picture;
use fab_picture::{DepthImage, Mask, SubpixelPoint};
use fab_program::{PixelPoint, Response, Sight};
use image::{RgbImage, imageops};
use std::ops::RangeInclusive;

/// How corners are searched for.
#[derive(Clone, Debug, PartialEq)]
pub struct CornerSearch {
    /// What the detector looks at.
    pub of: Sight,
    /// Side of the square picture that the detector sees, pixels.
    pub image_px: u32,
    /// The most corners kept, strongest first; 1 to 10 000.
    pub max: u32,
    /// Least accepted response as a fraction of the strongest, `0 < quality <= 1`.
    pub quality: f64,
    /// Least distance between corners, pixels of the detector's picture.
    pub spacing_px: f64,
    /// Side of the square over which a response is averaged, pixels of the detector's picture; odd, 1 to 31.
    pub block_px: u32,
    /// What counts as a strong response.
    pub response: Response,
}

/// How far off the cloth a detected corner may be and still snap to a cloth pixel, pixels of the camera image.
/// Downscaling moves a corner by up to two camera pixels; one more is for rounding.
const SNAP_PX: f64 = 3.0;

/// Finds the cloth's corners, strongest first.
///
/// The detector sees the depth in centimetres, the mask in white or `rgb` in grey, as `search.of` says, and 0 for
/// everything that is not cloth. If its picture has the camera's size, corners are returned as found.
///
/// Otherwise its picture is scaled to `search.image_px` squared (bicubic), and corners are scaled back by pixel
/// centres. On a smaller picture a corner is known only to one of its pixels, and a rounded response lies inside the
/// cloth, so the corner is then refined on the camera's own picture, to the point where the outline's edges around it
/// meet. The result is rounded and moved into the image. If it is off the cloth by at most 3 px, it is moved to the
/// nearest cloth pixel; if farther, it stays.
///
/// An empty mask has no corners. Fails if a picture or a setting is out of range, or if picture, mask and depth image
/// differ in size.
pub fn corners(
    depth: &DepthImage,
    rgb: &RgbImage,
    mask: &Mask,
    search: &CornerSearch,
) -> Result<Vec<SubpixelPoint>, VisionError> {
    let (width, height) = depth.dimensions();
    check_size(width, height)?;
    let sizes = [
        ("picture", rgb.dimensions()),
        ("mask", (mask.width(), mask.height())),
    ];
    for (what, size) in sizes {
        if size != (width, height) {
            return Err(VisionError(format!(
                "the {what} has {} x {} px, the depth image {width} x {height} px",
                size.0, size.1
            )));
        }
    }
    check_search(search)?;
    let Some(around) = bounding_box(mask) else {
        return Ok(Vec::new());
    };
    let picture = detector_picture(depth, rgb, mask, search.of, search.image_px);
    if (width, height) == (search.image_px, search.image_px) {
        let [left, top, width, height] = window(mask, around, search);
        let cloth = imageops::crop_imm(&picture, left, top, width, height).to_image();
        let corner = |[x, y]: [f32; 2]| {
            let at = [(x, left), (y, top)].map(|(at, first)| f64::from(at) + f64::from(first));
            SubpixelPoint {
                pixel: PixelPoint::new(at[0] as i32, at[1] as i32),
                at: at.map(|at| at + 0.5),
            }
        };
        let found = corners_of_gray(&cloth, search)?;
        return Ok(found.into_iter().map(corner).collect());
    }
    let found = corners_of_gray(&picture, search)?;
    let scale_back = |at: f32, side: u32| {
        let scale = f64::from(side) / f64::from(search.image_px);
        ((f64::from(at) + 0.5) * scale - 0.5) as f32
    };
    let scaled: Vec<[f32; 2]> = found
        .into_iter()
        .map(|[x, y]| [scale_back(x, width), scale_back(y, height)])
        .collect();
    let coarseness_px = (f64::from(width.max(height)) / f64::from(search.image_px)).ceil();
    let located = if coarseness_px > 1.0 {
        locate(scaled, mask, coarseness_px)?
    } else {
        scaled
    };
    let whole = |at: f32, side: u32| f64::from(at).round().clamp(0.0, f64::from(side - 1)) as i32;
    let corner = |[x, y]: [f32; 2]| SubpixelPoint {
        pixel: snap(PixelPoint::new(whole(x, width), whole(y, height)), mask),
        at: [x, y].map(|at| f64::from(at) + 0.5),
    };
    Ok(located.into_iter().map(corner).collect())
}

/// Returns left, top, width and height of the part of a picture that can influence the detector; outside it everything
/// is black.
///
/// A response depends on half the averaging square plus one pixel each for the gradient and for a stronger neighbour;
/// the margin is ample.
fn window(mask: &Mask, around: [PixelPoint; 2], search: &CornerSearch) -> [u32; 4] {
    let margin_px = search.block_px + 4;
    let [low, high] = around;
    let first = |at: i32| (at.max(0) as u32).saturating_sub(margin_px);
    let size =
        |at: i32, first: u32, side: u32| (at.max(0) as u32 + margin_px + 1).min(side) - first;
    let [left, top] = [first(low.u), first(low.v)];
    let (width, height) = (mask.width(), mask.height());
    [
        left,
        top,
        size(high.u, left, width),
        size(high.v, top, height),
    ]
}

/// Moves corners to where the mask's edges around them meet.
///
/// `coarseness_px` is how many pixels of the mask one pixel of the detector's picture spans. A corner that would leave
/// its window, which happens on a straight edge, stays where it was.
fn locate(
    corners: Vec<[f32; 2]>,
    mask: &Mask,
    coarseness_px: f64,
) -> Result<Vec<[f32; 2]>, VisionError> {
    // A detected corner is off by up to two pixels of its picture (see SNAP_PX); the window covers that.
    let window_px = 2 * coarseness_px as u32;
    if mask.width().min(mask.height()) <= 2 * window_px + 5 {
        return Ok(corners);
    }
    chosen::refine_corners(&mask_picture(mask), &corners, window_px)
}

/// Finds the corners of a grey picture, strongest first, as `[x, y]` in its own pixels.
///
/// What OpenCV's `goodFeaturesToTrack` finds, in its order; `search.of` and `search.image_px` are not used.
pub fn corners_of_gray(
    gray: &image::GrayImage,
    search: &CornerSearch,
) -> Result<Vec<[f32; 2]>, VisionError> {
    check_size(gray.width(), gray.height())?;
    check_search(search)?;
    chosen::strong_corners(gray, search)
}

/// Rejects settings without a meaning, such as 0 corners, which OpenCV takes as no limit.
fn check_search(search: &CornerSearch) -> Result<(), VisionError> {
    let side = f64::from(MAX_SIDE_PX);
    within("image", f64::from(search.image_px), 1.0..=side, "1 to 8192")?;
    within("max", f64::from(search.max), 1.0..=1e4, "1 to 10000")?;
    let range = "above 0 and at most 1";
    within("quality", search.quality, f64::MIN_POSITIVE..=1.0, range)?;
    within("spacing", search.spacing_px, 0.0..=1e4, "0 to 10000")?;
    let block_px = f64::from(search.block_px);
    let last = if search.block_px % 2 == 1 { 31.0 } else { 0.0 };
    within("block", block_px, 1.0..=last, "odd, 1 to 31")?;
    match search.response {
        Response::Harris { k } => within("k", k, 0.0..=1.0, "0 to 1"),
        Response::ShiTomasi => Ok(()),
    }
}

/// Rejects a setting outside of its range.
pub(super) fn within(
    name: &str,
    value: f64,
    limits: RangeInclusive<f64>,
    range: &str,
) -> Result<(), VisionError> {
    if limits.contains(&value) {
        Ok(())
    } else {
        Err(VisionError(format!(
            "`{name}` is {value}; it must be {range}"
        )))
    }
}

fn snap(corner: PixelPoint, mask: &Mask) -> PixelPoint {
    match mask.nearest(corner) {
        Some(nearest) if corner.distance_px(nearest) <= SNAP_PX => nearest,
        _ => corner,
    }
}
