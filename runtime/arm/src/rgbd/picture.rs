//! Decodes a camera's messages: colour, aligned depth, and intrinsics.
//!
//! In: untrusted `sensor_msgs` messages. Out: pictures in the crate's own types, or why a message cannot be used.

use super::Intrinsics;
use super::topics::{CameraInfo, Image};
use fab_picture::DepthImage;
use image::{Rgb, RgbImage};

/// The only distortion model with known coefficients; other models are accepted only if all are zero.
const PLUMB_BOB: &str = "plumb_bob";

/// Formats of colour: the bytes of a pixel, and which of them are red, green and blue.
const COLORS: [(&str, usize, [usize; 3]); 5] = [
    ("rgb8", 3, [0, 1, 2]),
    ("bgr8", 3, [2, 1, 0]),
    ("rgba8", 4, [0, 1, 2]),
    ("bgra8", 4, [2, 1, 0]),
    ("mono8", 1, [0, 0, 0]),
];

/// Reads a colour picture.
pub(super) fn color(message: &Image) -> Result<RgbImage, String> {
    let known = COLORS.iter().find(|(name, ..)| *name == message.encoding);
    let Some((_, n_bytes, order)) = known else {
        return Err(format!(
            "its colour is encoded as `{}`, and would be right as `{}`",
            message.encoding,
            COLORS.map(|(name, ..)| name).join("`, `")
        ));
    };
    let pixel = pixels(message, *n_bytes)?;
    Ok(RgbImage::from_fn(
        message.width,
        message.height,
        |column, row| Rgb(order.map(|channel| pixel(column, row)[channel])),
    ))
}

/// Reads a depth picture, metres: `16UC1` in millimetres or `32FC1` in metres; missing readings become 0.
pub(super) fn depth(message: &Image) -> Result<DepthImage, String> {
    let n_bytes = match message.encoding.as_str() {
        "16UC1" | "mono16" => 2,
        "32FC1" => 4,
        other => {
            return Err(format!(
                "its depth is encoded as `{other}`; expected `16UC1` or `32FC1`"
            ));
        }
    };
    let pixel = pixels(message, n_bytes)?;
    let depth_m = |column: u32, row: u32| {
        let depth_m = match (pixel(column, row), message.is_bigendian) {
            (&[a, b], false) => f32::from(u16::from_le_bytes([a, b])) / 1000.0,
            (&[a, b], true) => f32::from(u16::from_be_bytes([a, b])) / 1000.0,
            (&[a, b, c, d], false) => f32::from_le_bytes([a, b, c, d]),
            (&[a, b, c, d], true) => f32::from_be_bytes([a, b, c, d]),
            _ => 0.0,
        };
        let is_reading = depth_m.is_finite() && depth_m > 0.0;
        image::Luma([if is_reading { depth_m } else { 0.0 }])
    };
    Ok(DepthImage::from_fn(message.width, message.height, depth_m))
}

/// Reads a camera's projection; `None` if the message says that it was never calibrated.
///
/// `sensor_msgs` counts pixels from their centres, so its principal point is half a pixel less than [`Intrinsics`]'.
pub(super) fn intrinsics(
    message: &CameraInfo,
    size_px: [u32; 2],
) -> Result<Option<Intrinsics>, String> {
    let found = [message.width, message.height];
    if found != size_px {
        return Err(format!(
            "its `camera_info` is for {found:?} pixels, and its picture has {size_px:?}"
        ));
    }
    let is_binned = message.binning.iter().any(|n_pixels| *n_pixels > 1);
    if is_binned || message.offset_px != [0, 0] {
        return Err("its `camera_info` has a region of interest or binning: set the camera to full frames without \
            binning".to_owned());
    }
    let [focal_x, _, middle_x, _, focal_y, middle_y, ..] = message.k;
    if focal_x == 0.0 {
        return Ok(None);
    }
    let mut distortion = message.d.clone();
    if distortion.iter().all(|coefficient| *coefficient == 0.0) {
        distortion.clear();
    }
    if !distortion.is_empty() && (message.distortion_model != PLUMB_BOB || distortion.len() != 5) {
        let model = &message.distortion_model;
        let count = distortion.len();
        return Err(format!(
            "its distortion is `{model}` with {count} coefficients, and would be right as `{PLUMB_BOB}` with 5"
        ));
    }
    let numbers = [focal_x, focal_y, middle_x, middle_y];
    let mut numbers = numbers.iter().chain(&distortion);
    if !numbers.all(|number| number.is_finite()) || focal_x <= 0.0 || focal_y <= 0.0 {
        return Err(format!(
            "its `camera_info` gives the focal lengths `{focal_x}` and `{focal_y}`, or numbers that are not finite"
        ));
    }
    Ok(Some(Intrinsics {
        size_px,
        focal_px: [focal_x, focal_y],
        middle_px: [middle_x + 0.5, middle_y + 0.5],
        distortion,
    }))
}

/// Returns the bytes of each pixel by its column and row; fails if the sizes that a message states disagree.
fn pixels<'a>(message: &'a Image, n_bytes: usize) -> Result<impl Fn(u32, u32) -> &'a [u8], String> {
    let (width, height, step) = (message.width, message.height, message.step as usize);
    let n_found = message.data.len();
    let holds = step >= width as usize * n_bytes && n_found == step * height as usize;
    if width == 0 || height == 0 || !holds {
        return Err(format!(
            "its picture of {width} x {height} px as `{}` has rows of {step} bytes, and {n_found} bytes in all",
            message.encoding
        ));
    }
    Ok(move |column: u32, row: u32| {
        let start = row as usize * step + column as usize * n_bytes;
        &message.data[start..start + n_bytes]
    })
}

#[cfg(test)]
mod tests;
