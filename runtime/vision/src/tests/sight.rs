//! Tests of the picture that a corner detector looks at.

use super::super::sight::detector_picture;
use super::super::*;
use super::{assert_refused, harris};
use crate::recorded::recorded_data;
use fab_picture::DepthImage;
use fab_picture::Mask;
use fab_picture::SubpixelPoint;
use fab_program::{PixelPoint, Response, Sight};
use image::{GrayImage, Luma, Rgb, RgbImage};

/// A light square on dark ground, at the same depth.
fn observation(side_px: u32) -> (DepthImage, RgbImage, Mask) {
    let is_cloth = |column: u32, row: u32| {
        let cloth = side_px / 4..3 * side_px / 4;
        cloth.contains(&column) && cloth.contains(&row)
    };
    let depth = DepthImage::from_pixel(side_px, side_px, Luma([0.6]));
    let rgb = RgbImage::from_fn(side_px, side_px, |column, row| {
        Rgb(if is_cloth(column, row) {
            [250, 120, 30]
        } else {
            [90, 20, 200]
        })
    });
    (depth, rgb, Mask::from_fn(side_px, side_px, is_cloth))
}

fn is_inside(mask: &Mask, column: u32, row: u32) -> bool {
    mask.contains(PixelPoint::new(column as i32, row as i32))
}

#[test]
fn each_sight_shows_the_cloth_alone_and_as_declared() {
    let (depth, rgb, mask) = observation(64);
    // 60 cm; white; 0.299 * 250 + 0.587 * 120 + 0.114 * 30 = 148.6.
    for (of, level) in [
        (Sight::Depth, 60),
        (Sight::Mask, 255),
        (Sight::Picture, 149),
        // Hue 60, saturation 120 of 255, value 250: 250, 250 and 132, weighted as blue, green and red.
        (Sight::MisreadPicture, 215),
    ] {
        for side_px in [64, 32] {
            let picture = detector_picture(&depth, &rgb, &mask, of, side_px);
            let scale = 64 / side_px;
            let expected = GrayImage::from_fn(side_px, side_px, |column, row| {
                Luma([if is_inside(&mask, scale * column, scale * row) {
                    level
                } else {
                    0
                }])
            });
            assert_eq!(picture, expected, "{of:?} at {side_px}");
        }
    }
}

#[test]
fn a_square_has_four_corners_however_it_is_seen() {
    let (depth, rgb, mask) = observation(160);
    for of in [Sight::Depth, Sight::Mask, Sight::Picture] {
        for image_px in [160, 80] {
            let search = CornerSearch {
                of,
                image_px,
                ..harris()
            };
            let found = corners(&depth, &rgb, &mask, &search).unwrap();
            assert_eq!(found.len(), 4, "{of:?} at {image_px}: {found:?}");
            for (u, v) in [(40, 40), (119, 40), (40, 119), (119, 119)] {
                let is_near = |c: &SubpixelPoint| c.pixel.distance_px(PixelPoint::new(u, v)) <= 3.0;
                assert!(found.iter().any(is_near), "{of:?} at {image_px}: {found:?}");
            }
        }
    }
}

#[test]
fn a_fold_inside_the_cloth_shows_in_the_picture_alone() {
    let (depth, mut rgb, mask) = observation(160);
    for (column, row, pixel) in rgb.enumerate_pixels_mut() {
        if (70..90).contains(&column) && (60..100).contains(&row) {
            pixel.0 = [20, 20, 20];
        }
    }
    let found = |of| {
        let search = CornerSearch {
            of,
            image_px: 160,
            ..harris()
        };
        corners(&depth, &rgb, &mask, &search).unwrap().len()
    };
    assert_eq!(
        [Sight::Depth, Sight::Mask, Sight::Picture].map(found),
        [4, 4, 8]
    );
}

#[test]
fn at_the_cameras_size_corners_are_as_the_detector_found_them() {
    let (depth, rgb, mask) = observation(160);
    let search = CornerSearch {
        of: Sight::Mask,
        image_px: 160,
        block_px: 7,
        ..harris()
    };
    let picture = detector_picture(&depth, &rgb, &mask, Sight::Mask, 160);
    let bare = corners_of_gray(&picture, &search).unwrap();
    let found = corners(&depth, &rgb, &mask, &search).unwrap();
    assert_eq!(found.len(), bare.len());
    for (corner, [x, y]) in found.iter().zip(&bare) {
        assert_eq!(corner.pixel, PixelPoint::new(*x as i32, *y as i32));
        assert_eq!(corner.at, [f64::from(*x) + 0.5, f64::from(*y) + 0.5]);
    }
    // A wider square is averaged, so the strongest response moves.
    let narrow = CornerSearch {
        block_px: 3,
        ..search
    };
    assert_ne!(corners(&depth, &rgb, &mask, &narrow).unwrap(), found);
}

/// A patterned cloth, between two columns and two rows of a dark picture.
fn patterned(side_px: u32, [left, top, right, bottom]: [u32; 4]) -> (DepthImage, RgbImage, Mask) {
    let depth = DepthImage::from_pixel(side_px, side_px, Luma([0.6]));
    let rgb = RgbImage::from_fn(side_px, side_px, |column, row| {
        let level = (column * 7 + row * row * 3 + column * row) % 97;
        Rgb([150 + level as u8, 90, 30 + (row % 5) as u8 * 20])
    });
    let mask = Mask::from_fn(side_px, side_px, |column, row| {
        (left..right).contains(&column) && (top..bottom).contains(&row)
    });
    (depth, rgb, mask)
}

#[test]
fn the_part_of_the_picture_around_the_cloth_has_the_corners_of_the_whole() {
    let places = [
        [60, 50, 117, 99],
        [0, 0, 61, 47],
        [99, 88, 160, 160],
        [0, 70, 160, 95],
    ];
    let mut n_whole = 0;
    let responses = [Response::ShiTomasi, Response::Harris { k: 0.04 }];
    for (place, block_px, response) in places
        .into_iter()
        .flat_map(|place| [3, 7, 31].map(|block_px| (place, block_px)))
        .flat_map(|(place, block_px)| responses.map(|response| (place, block_px, response)))
    {
        let (depth, rgb, mask) = patterned(160, place);
        let search = CornerSearch {
            of: Sight::Picture,
            image_px: 160,
            max: 40,
            quality: 0.02,
            block_px,
            response,
            ..harris()
        };
        let picture = detector_picture(&depth, &rgb, &mask, Sight::Picture, 160);
        let whole = corners_of_gray(&picture, &search).unwrap();
        let whole: Vec<PixelPoint> = whole
            .iter()
            .map(|[x, y]| PixelPoint::new(*x as i32, *y as i32))
            .collect();
        let found = corners(&depth, &rgb, &mask, &search).unwrap();
        let found: Vec<PixelPoint> = found.iter().map(|corner| corner.pixel).collect();
        n_whole += whole.len();
        assert_eq!(found, whole, "{place:?} {block_px} {response:?}");
    }
    assert!(n_whole > 100, "{n_whole}");
}

#[test]
fn a_picture_or_block_that_does_not_fit_is_refused() {
    let (depth, rgb, mask) = observation(64);
    for block_px in [0, 4, 33, u32::MAX] {
        let search = CornerSearch {
            block_px,
            ..harris()
        };
        assert_refused(
            corners(&depth, &rgb, &mask, &search),
            &format!("`{}` is", "block"),
        );
    }
    assert_refused(
        corners(&depth, &RgbImage::new(64, 63), &mask, &harris()),
        "the depth image",
    );
}

/// The recordings used a grey picture of the camera's size, which shows more than a mask does.
#[test]
#[ignore = "long"]
fn corners_of_a_picture_match_the_recorded_lists_in_order() {
    let Some(root) = recorded_data("corners_of_a_picture_match_the_recorded_lists_in_order") else {
        return;
    };
    let manifest = std::fs::read_to_string(root.join("vision/shi_tomasi/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    let mut n_pictures = 0;
    for fixture in manifest["fixtures"].as_array().unwrap() {
        let folder = root.join(fixture["dir"].as_str().unwrap());
        if !folder.exists() {
            continue;
        }
        let rgb = image::open(folder.join("gray.png")).unwrap().into_rgb8();
        let (width, height) = rgb.dimensions();
        let search = CornerSearch {
            of: Sight::Picture,
            image_px: width,
            max: fixture["corner_limit"].as_u64().unwrap() as u32,
            quality: 0.1,
            spacing_px: 20.0,
            block_px: 3,
            response: Response::ShiTomasi,
        };
        let everything = Mask::from_fn(width, height, |_, _| true);
        let found = corners(&DepthImage::new(width, height), &rgb, &everything, &search).unwrap();
        let pixels: Vec<_> = found.iter().map(|corner| corner.pixel).collect();
        let expected = fixture["recorded_corners"].clone();
        let expected: Vec<PixelPoint> = serde_json::from_value(expected).unwrap();
        assert_eq!(pixels, expected, "{}", folder.display());
        n_pictures += 1;
    }
    assert!(n_pictures >= 10, "{n_pictures} pictures");
}
