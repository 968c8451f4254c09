//! The keypoints of one picture, as JSON; the test on the other side includes this file too.

use fab_picture::{DepthImage, Mask};
use fab_program::{Response, Sight};
use fab_vision::{CornerSearch, contour, corners, corners_of_gray, rectangle_around};
use image::{GrayImage, Luma, RgbImage};
use serde_json::{Value, json};

/// Finds strong corners, the outline of what is not black, and the smallest rectangle around it.
pub fn of(picture: &Value) -> Value {
    let Some((gray, search)) = read(picture) else {
        return json!({ "error": "not a picture" });
    };
    let mask = Mask::from_fn(gray.width(), gray.height(), |column, row| {
        gray.get_pixel(column, row).0[0] > 0
    });
    let outline = contour(&mask, 3.0).unwrap_or_default();
    // On a smaller picture corners are refined.
    let depth = DepthImage::from_fn(gray.width(), gray.height(), |column, row| {
        Luma([f32::from(gray.get_pixel(column, row).0[0]) / 100.0])
    });
    let smaller = CornerSearch {
        image_px: gray.width() / 2,
        ..search.clone()
    };
    let rgb = RgbImage::new(gray.width(), gray.height());
    let refined = corners(&depth, &rgb, &mask, &smaller).unwrap_or_default();
    let rectangle = rectangle_around(&mask).ok().flatten();
    json!({
        "corners": corners_of_gray(&gray, &search).unwrap_or_default(),
        "outline": outline.iter().map(|at| [at.u, at.v]).collect::<Vec<_>>(),
        // As bits, so that nothing is rounded on the way.
        "refined": refined.iter().map(|corner| corner.at.map(f64::to_bits)).collect::<Vec<_>>(),
        "rectangle": rectangle.map(|found| {
            [found.center, found.along, found.sides].map(|pair| pair.map(f64::to_bits))
        }),
    })
}

fn read(picture: &Value) -> Option<(GrayImage, CornerSearch)> {
    let width = u32::try_from(picture["width"].as_u64()?).ok()?;
    let hex = picture["levels"].as_str()?;
    let levels: Option<Vec<u8>> = (0..hex.len() / 2)
        .map(|at| u8::from_str_radix(hex.get(2 * at..2 * at + 2)?, 16).ok())
        .collect();
    let levels = levels?;
    let height = levels.len() as u32 / width;
    let is_harris = picture["harris"].as_bool()?;
    let search = CornerSearch {
        of: Sight::Depth,
        image_px: width,
        max: u32::try_from(picture["max"].as_u64()?).ok()?,
        quality: if is_harris { 0.04 } else { 0.1 },
        spacing_px: if is_harris { 10.0 } else { 20.0 },
        block_px: 3,
        response: if is_harris {
            Response::Harris { k: 0.04 }
        } else {
            Response::ShiTomasi
        },
    };
    Some((GrayImage::from_raw(width, height, levels)?, search))
}
