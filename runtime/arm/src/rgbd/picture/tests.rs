//! Tests of a camera's messages.

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
            "px as `rgb8` has rows of 3 bytes",
        ),
        (
            color(&short).err(),
            "has rows of 3 bytes, and 3 bytes in all",
        ),
        (
            color(&message("rgb8", 0, 0, &[])).err(),
            "picture of 0 x 0 px",
        ),
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
