//! Decodes a camera's messages: colour, aligned depth, and intrinsics.
//!
//! In: untrusted `sensor_msgs` messages. Out: pictures in the crate's own types, or why a message cannot be used.

use super::Intrinsics;
use super::topics::{CameraInfo, Image};
use fab_picture::DepthImage;
use image::{Rgb, RgbImage};

/// The only distortion model with known coefficients; other models are accepted only if all are zero.
const PLUMB_BOB: &str = "plumb_bob";

/// Reads a colour picture: `rgb8`, `bgr8`, `rgba8`, `bgra8` or `mono8`.
pub(super) fn color(message: &Image) -> Result<RgbImage, String> {
    let (n_bytes, order) = match message.encoding.as_str() {
        "rgb8" => (3, [0, 1, 2]),
        "bgr8" => (3, [2, 1, 0]),
        "rgba8" => (4, [0, 1, 2]),
        "bgra8" => (4, [2, 1, 0]),
        "mono8" => (1, [0, 0, 0]),
        other => {
            let known = "`rgb8`, `bgr8`, `rgba8`, `bgra8` or `mono8`";
            return Err(format!(
                "its colour is encoded as `{other}`, and would be right as {known}"
            ));
        }
    };
    let rows = Rows::of(message, n_bytes)?;
    Ok(RgbImage::from_fn(
        message.width,
        message.height,
        |column, row| {
            let pixel = rows.pixel(column, row);
            Rgb(order.map(|channel| pixel[channel]))
        },
    ))
}

/// Reads a depth picture, metres: `16UC1` in millimetres or `32FC1` in metres; missing readings become 0.
pub(super) fn depth(message: &Image) -> Result<DepthImage, String> {
    let is_big = message.is_bigendian;
    let read: fn(&[u8], bool) -> f32 = match message.encoding.as_str() {
        "16UC1" | "mono16" => |pixel, is_big| {
            let bytes = [pixel[0], pixel[1]];
            f32::from(if is_big {
                u16::from_be_bytes(bytes)
            } else {
                u16::from_le_bytes(bytes)
            }) / 1000.0
        },
        "32FC1" => |pixel, is_big| {
            let bytes = [pixel[0], pixel[1], pixel[2], pixel[3]];
            if is_big {
                f32::from_be_bytes(bytes)
            } else {
                f32::from_le_bytes(bytes)
            }
        },
        other => {
            return Err(format!(
                "its depth is encoded as `{other}`; expected `16UC1` or `32FC1`"
            ));
        }
    };
    let rows = Rows::of(message, if message.encoding == "32FC1" { 4 } else { 2 })?;
    Ok(DepthImage::from_fn(
        message.width,
        message.height,
        |column, row| {
            let depth_m = read(rows.pixel(column, row), is_big);
            image::Luma([if depth_m.is_finite() && depth_m > 0.0 {
                depth_m
            } else {
                0.0
            }])
        },
    ))
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
    let distortion: Vec<f64> = match message.d.iter().all(|coefficient| *coefficient == 0.0) {
        true => Vec::new(),
        false => message.d.clone(),
    };
    if !distortion.is_empty() && (message.distortion_model != PLUMB_BOB || distortion.len() != 5) {
        let model = &message.distortion_model;
        let count = distortion.len();
        return Err(format!(
            "its distortion is `{model}` with {count} coefficients, and would be right as `{PLUMB_BOB}` with 5"
        ));
    }
    let numbers = [focal_x, focal_y, middle_x, middle_y];
    let is_sound = numbers
        .iter()
        .chain(&distortion)
        .all(|number| number.is_finite());
    if !is_sound || focal_x <= 0.0 || focal_y <= 0.0 {
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

/// The pixels of a message with consistent sizes.
struct Rows<'a> {
    bytes: &'a [u8],
    step: usize,
    n_bytes: usize,
}

impl<'a> Rows<'a> {
    fn of(message: &'a Image, n_bytes: u32) -> Result<Rows<'a>, String> {
        let (width, height, step) = (message.width, message.height, message.step);
        if width == 0 || height == 0 {
            return Err(format!("its picture has {width} x {height} pixels"));
        }
        let least = u64::from(width) * u64::from(n_bytes);
        if u64::from(step) < least {
            let encoding = &message.encoding;
            return Err(format!(
                "its rows have {step} bytes, and {width} pixels of `{encoding}` need {least}"
            ));
        }
        let whole = u64::from(step) * u64::from(height);
        if message.data.len() as u64 != whole {
            let found = message.data.len();
            return Err(format!(
                "its picture has {found} bytes, and {height} rows of {step} would be {whole}"
            ));
        }
        Ok(Rows {
            bytes: &message.data,
            step: step as usize,
            n_bytes: n_bytes as usize,
        })
    }

    fn pixel(&self, column: u32, row: u32) -> &'a [u8] {
        let start = row as usize * self.step + column as usize * self.n_bytes;
        &self.bytes[start..start + self.n_bytes]
    }
}

#[cfg(test)]
mod tests;
