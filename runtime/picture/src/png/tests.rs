//! Tests of pictures from outside: what they are, how they are turned, and what is transparent.

#![allow(clippy::unwrap_used)]

use super::*;
use image::{GrayImage, ImageEncoder, Luma, LumaA, Rgba, RgbaImage};
use std::fs;

/// A picture whose left half is red and whose right half is blue, 40 by 20.
fn halves() -> RgbImage {
    RgbImage::from_fn(40, 20, |column, _| {
        Rgb(if column < 20 {
            [250, 0, 0]
        } else {
            [0, 0, 250]
        })
    })
}

/// Encodes a picture with an orientation in its Exif data.
fn with_orientation(format: ImageFormat, orientation: u8) -> Vec<u8> {
    let exif = [
        &b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"[..],
        &[orientation, 0, 0, 0, 0, 0, 0, 0],
    ]
    .concat();
    let (picture, mut bytes) = (halves(), Vec::new());
    let colour = image::ExtendedColorType::Rgb8;
    match format {
        ImageFormat::Png => {
            let mut encoder = image::codecs::png::PngEncoder::new(&mut bytes);
            encoder.set_exif_metadata(exif).unwrap();
            encoder
                .write_image(picture.as_raw(), 40, 20, colour)
                .unwrap();
        }
        _ => {
            let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 95);
            encoder.set_exif_metadata(exif).unwrap();
            encoder
                .write_image(picture.as_raw(), 40, 20, colour)
                .unwrap();
        }
    }
    bytes
}

#[test]
fn a_picture_is_read_by_its_content_and_turned_as_it_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("named.png");
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        // Where red is: on the left, on the right, on top, at the bottom.
        for (orientation, size, red, blue) in [
            (1, (40, 20), (5, 10), (35, 10)),
            (3, (40, 20), (35, 10), (5, 10)),
            (6, (20, 40), (10, 5), (10, 35)),
            (8, (20, 40), (10, 35), (10, 5)),
        ] {
            fs::write(&path, with_orientation(format, orientation)).unwrap();
            let opened = load(&path).unwrap();
            assert_eq!(opened.dimensions(), size);
            let [red, blue] = [red, blue].map(|(column, row)| opened.get_pixel(column, row).0);
            assert!(
                red[0] > 200 && red[2] < 50,
                "{format:?} {orientation}: {red:?}"
            );
            assert!(
                blue[2] > 200 && blue[0] < 50,
                "{format:?} {orientation}: {blue:?}"
            );
        }
    }
}

fn as_png(picture: impl Into<DynamicImage>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture
        .into()
        .write_to(&mut bytes, ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

#[test]
fn what_is_transparent_is_white() {
    let of_alpha = |alpha: u8| {
        RgbaImage::from_fn(4, 2, move |column, _| {
            Rgba([10, 20, 30, if column == 0 { alpha } else { 255 }])
        })
    };
    let grey = image::ImageBuffer::from_pixel(2, 1, LumaA([40_u8, 0]));
    let deep = image::ImageBuffer::from_pixel(2, 1, Rgba([1000_u16, 2000, 3000, 0]));
    let rows: [(Vec<u8>, [u8; 3]); 5] = [
        (as_png(of_alpha(255)), [10, 20, 30]),
        (as_png(of_alpha(0)), [255; 3]),
        (as_png(of_alpha(51)), [206, 208, 210]),
        (as_png(grey), [255; 3]),
        (as_png(deep), [255; 3]),
    ];
    for (bytes, first) in rows {
        let opened = opened(&bytes, Path::new("a.png")).unwrap();
        assert_eq!(opened.get_pixel(0, 0).0, first);
        assert!(opened.width() < 4 || opened.get_pixel(1, 1).0 == [10, 20, 30]);
    }
}

#[test]
fn a_file_that_is_no_picture_is_named_with_what_to_do() {
    let wide = as_png(RgbImage::new(MAX_SIDE_PX + 1, 1));
    let cut = &as_png(halves())[..60];
    let rows: [(&str, &[u8], &str); 7] = [
        (
            "a b.webp",
            b"RIFF\0\0\0\0WEBPVP8 ",
            "`a b.webp` is a WebP picture; PNG and JPEG are read, and ImageMagick converts it: `magick FILE out.png`",
        ),
        (
            "a.heic",
            b"\0\0\0\x18ftypheic",
            "`a.heic` is a HEIC picture; PNG and JPEG are read",
        ),
        (
            "a.png",
            b"version https://git-lfs.github.com/spec/v1\noid sha256:1",
            "`a.png` is a Git LFS pointer, not the file itself; `git lfs pull` fetches it",
        ),
        ("a.png", b"", "`a.png` is empty"),
        (
            "a.png",
            b"words",
            "`a.png` is not a readable picture in PNG or JPEG: it begins like no picture",
        ),
        (
            "a.png",
            cut,
            "`a.png` is not a readable picture in PNG or JPEG",
        ),
        (
            "a.png",
            &wide,
            "`a.png` is 8193 by 1 pixels; at most 8192 by 8192 pixels are accepted: `magick FILE -resize",
        ),
    ];
    for (name, bytes, told) in rows {
        let why = opened(bytes, Path::new(name)).unwrap_err().to_string();
        assert!(why.starts_with(told), "{why}");
    }
}

#[test]
fn a_photograph_that_was_cut_off_is_refused_and_one_with_more_behind_it_is_not() {
    let whole = with_orientation(ImageFormat::Jpeg, 1);
    let path = Path::new("a.jpg");
    // A small picture in a segment before the pixels, with marks of its own, as cameras add them.
    let small = b"\xff\xe1\x00\x0a\xff\xda\x00\x00\xff\xd9\x00\x00";
    let with_small = [&whole[..2], small, &whole[2..]].concat();
    let with_more = [&whole[..], b"MotionPhoto \xff\xda"].concat();
    for bytes in [&whole, &with_small, &with_more] {
        assert_eq!(opened(bytes, path).unwrap().dimensions(), (40, 20));
    }
    for length in 3..whole.len() - 1 {
        let why = opened(&whole[..length], path).unwrap_err().to_string();
        assert!(
            why.contains("`a.jpg` is not a readable picture in PNG or JPEG"),
            "{why}"
        );
    }
}

#[test]
fn a_depth_picture_is_a_grey_png() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("d.png");
    let named = path.display().to_string();
    fs::write(&path, encode(&GrayImage::from_pixel(2, 1, Luma([51])))).unwrap();
    assert_eq!(load_depth(&path).unwrap().get_pixel(1, 0).0, [0.2]);
    let levels =
        image::ImageBuffer::from_fn(2, 1, |column, _| Luma([[650, u16::MAX][column as usize]]));
    fs::write(&path, as_png(levels)).unwrap();
    assert_eq!(load_depth(&path).unwrap().into_raw(), [0.65, 0.0]);
    for (bytes, told) in [
        (
            with_orientation(ImageFormat::Jpeg, 1),
            "is a JPEG picture; a depth picture is a grey PNG, of 8 or 16 bits, since a format for photographs changes distances",
        ),
        (
            as_png(halves()),
            "is a picture in Rgb8, not a depth picture",
        ),
        (b"\x93NUMPY\x01\0".to_vec(), "is an array of NumPy (`.npy`)"),
    ] {
        fs::write(&path, bytes).unwrap();
        let why = load_depth(&path).unwrap_err().to_string();
        assert!(why.starts_with(&format!("`{named}` {told}")), "{why}");
    }
}
