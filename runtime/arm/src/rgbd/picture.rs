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
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use proptest::prelude::*;

    fn message(encoding: &str, width: u32, step: u32, data: &[u8]) -> Image {
        Image {
            width,
            height: data.len() as u32 / step.max(1),
            step,
            encoding: encoding.to_owned(),
            data: data.to_vec(),
            ..Image::default()
        }
    }

    #[test]
    fn each_encoding_gives_its_colours() {
        let cases: [(&str, u32, &[u8], [u8; 3]); 5] = [
            ("rgb8", 3, &[1, 2, 3], [1, 2, 3]),
            ("bgr8", 3, &[1, 2, 3], [3, 2, 1]),
            ("rgba8", 4, &[1, 2, 3, 9], [1, 2, 3]),
            ("bgra8", 4, &[1, 2, 3, 9], [3, 2, 1]),
            ("mono8", 1, &[7], [7, 7, 7]),
        ];
        for (encoding, step, bytes, expected) in cases {
            let picture = color(&message(encoding, 1, step, bytes)).unwrap();
            assert_eq!(picture.get_pixel(0, 0).0, expected, "{encoding}");
        }
    }

    #[test]
    fn rows_may_be_longer_than_their_pixels() {
        let picture = color(&message("mono8", 2, 3, &[1, 2, 99, 3, 4, 99])).unwrap();
        let values: Vec<u8> = picture.pixels().map(|pixel| pixel.0[0]).collect();
        assert_eq!(values, [1, 2, 3, 4]);
    }

    #[test]
    fn depth_is_metres_and_0_where_there_is_none() {
        let millimetres = message("16UC1", 3, 6, &[0, 0, 0xe8, 3, 0xff, 0xff]);
        assert_eq!(depth(&millimetres).unwrap().into_raw(), [0.0, 1.0, 65.535]);
        let swapped = Image {
            is_bigendian: true,
            ..message("16UC1", 1, 2, &[3, 0xe8])
        };
        assert_eq!(depth(&swapped).unwrap().into_raw(), [1.0]);
        let metres = [0.75_f32, f32::NAN, f32::INFINITY, -1.0]
            .map(f32::to_le_bytes)
            .concat();
        assert_eq!(
            depth(&message("32FC1", 4, 16, &metres)).unwrap().into_raw(),
            [0.75, 0.0, 0.0, 0.0]
        );
    }

    #[test]
    fn what_cannot_be_a_picture_is_refused_in_words() {
        let short = Image {
            height: 2,
            ..message("rgb8", 1, 3, &[1, 2, 3])
        };
        let faults = [
            (
                color(&message("yuv422", 1, 2, &[1, 2])).err(),
                "encoded as `yuv422`",
            ),
            (
                color(&message("rgb8", 2, 3, &[1, 2, 3])).err(),
                "rows have 3 bytes, and 2 pixels of `rgb8` need 6",
            ),
            (
                color(&short).err(),
                "has 3 bytes, and 2 rows of 3 would be 6",
            ),
            (color(&message("rgb8", 0, 0, &[])).err(), "0 x 0 pixels"),
            (
                depth(&message("rgb8", 1, 3, &[1, 2, 3])).err(),
                "expected `16UC1` or `32FC1`",
            ),
        ];
        for (found, expected) in faults {
            let found = found.unwrap();
            assert!(found.contains(expected), "{found}");
        }
    }

    fn info() -> CameraInfo {
        CameraInfo {
            width: 640,
            height: 480,
            k: [600.0, 0.0, 319.5, 0.0, 610.0, 239.5, 0.0, 0.0, 1.0],
            d: vec![0.0; 8],
            ..CameraInfo::default()
        }
    }

    #[test]
    fn the_principal_point_counts_from_a_pixels_corner() {
        let read = intrinsics(&info(), [640, 480]).unwrap().unwrap();
        assert_eq!(
            (read.focal_px, read.middle_px),
            ([600.0, 610.0], [320.0, 240.0])
        );
        assert!(read.distortion.is_empty());
    }

    #[test]
    fn a_projection_that_is_not_understood_is_refused() {
        let wide = CameraInfo {
            distortion_model: "equidistant".to_owned(),
            d: vec![0.1; 4],
            ..info()
        };
        let bent = CameraInfo {
            distortion_model: PLUMB_BOB.to_owned(),
            d: vec![0.1; 5],
            ..info()
        };
        let part = CameraInfo {
            binning: [2, 1],
            ..info()
        };
        let blind = CameraInfo {
            k: [0.0; 9],
            ..info()
        };
        let broken = CameraInfo {
            k: [f64::NAN; 9],
            ..info()
        };
        assert!(
            intrinsics(&wide, [640, 480])
                .unwrap_err()
                .contains("`equidistant` with 4")
        );
        assert_eq!(
            intrinsics(&bent, [640, 480]).unwrap().unwrap().distortion,
            [0.1; 5]
        );
        assert!(intrinsics(&part, [640, 480]).is_err());
        assert!(intrinsics(&info(), [320, 240]).is_err());
        assert_eq!(intrinsics(&blind, [640, 480]), Ok(None));
        assert!(intrinsics(&broken, [640, 480]).is_err());
    }

    proptest! {
        /// Any message gives a picture of its stated size or a reason, never a panic.
        #[test]
        fn any_message_is_read_or_refused(
            encoding in prop::sample::select(vec!["rgb8", "bgra8", "mono8", "16UC1", "32FC1", "mono16", "", "bayer"]),
            size in prop::array::uniform3(prop_oneof![0_u32..20, any::<u32>()]),
            is_bigendian: bool,
            data in prop::collection::vec(any::<u8>(), 0..400),
        ) {
            let [width, height, step] = size;
            let encoding = encoding.to_owned();
            let any = Image { width, height, step, is_bigendian, encoding, data, ..Image::default() };
            let step = (any.data.len() as u32).checked_div(height).unwrap_or(step);
            let likely = Image { step, data: any.data[..any.data.len().min((step * height) as usize)].to_vec(), ..any.clone() };
            for message in [any, likely] {
                if let Ok(picture) = color(&message) {
                    prop_assert_eq!(picture.dimensions(), (width, height));
                }
                if let Ok(picture) = depth(&message) {
                    prop_assert!(picture.pixels().all(|pixel| pixel.0[0].is_finite() && pixel.0[0] >= 0.0));
                }
            }
        }
    }
}
