//! Tests of masks by colour and of grey levels.

use super::super::color::{gray_level, misread};
use super::super::*;
use crate::recorded::recorded_data;
use fab_picture::Mask;
use fab_program::PixelPoint;
use image::{Rgb, RgbImage};

const ANY: [f64; 2] = [0.0, 1.0];

/// Returns whether a picture of one colour belongs to the mask.
fn is_in(rgb: [u8; 3], hue_deg: [f64; 2], saturation: [f64; 2], value: [f64; 2]) -> bool {
    let picture = RgbImage::from_pixel(1, 1, Rgb(rgb));
    color_mask(&picture, hue_deg, saturation, value).contains(PixelPoint::new(0, 0))
}

#[test]
fn hues_are_where_the_circle_has_them() {
    let hues = [
        ([255, 0, 0], 0.0),
        ([255, 255, 0], 60.0),
        ([0, 255, 0], 120.0),
        ([0, 255, 255], 180.0),
        ([0, 0, 255], 240.0),
        ([255, 0, 255], 300.0),
        ([255, 0, 17], 356.0),
        ([200, 100, 150], 330.0),
        ([90, 90, 90], 0.0),
    ];
    for (rgb, hue) in hues {
        assert!(is_in(rgb, [hue, hue], ANY, ANY), "{rgb:?} at {hue}");
        assert!(
            !is_in(rgb, [hue + 0.01, 359.99], ANY, ANY),
            "{rgb:?} above {hue}"
        );
    }
}

#[test]
fn saturation_and_value_are_the_decimals_that_they_are() {
    // 51 / 255 is a fifth, and 100 / 200 a half.
    assert!(is_in([51, 51, 51], [0.0, 0.0], [0.0, 0.0], [0.2, 0.2]));
    assert!(is_in([200, 100, 100], [0.0, 0.0], [0.5, 0.5], [0.7, 0.8]));
    assert!(!is_in([200, 101, 101], [0.0, 0.0], [0.5, 1.0], ANY));
    assert!(is_in([0, 0, 0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]));
}

#[test]
fn a_hue_range_may_pass_360() {
    let (red, pink, orange, blue) = ([255, 0, 0], [255, 0, 85], [255, 85, 0], [0, 0, 255]);
    for (rgb, expected) in [(red, true), (pink, true), (orange, true), (blue, false)] {
        assert_eq!(is_in(rgb, [340.0, 20.0], ANY, ANY), expected, "{rgb:?}");
    }
    // 360 equals 0, from whichever side the range comes.
    assert!(is_in(red, [340.0, 360.0], ANY, ANY));
    assert!(is_in(red, [360.0, 20.0], ANY, ANY));
    assert!(!is_in(red, [340.0, 359.0], ANY, ANY));
    assert!(!is_in(red, [1.0, 359.0], ANY, ANY));
    assert!(!is_in(red, [f64::NAN, 360.0], ANY, ANY));
}

#[test]
fn a_masks_pixels_are_painted_white_and_no_others() {
    let rgb = RgbImage::from_fn(4, 3, |column, row| Rgb([column as u8, row as u8, 7]));
    // The mask is wider and lower than the picture.
    let mask = Mask::from_fn(9, 2, |column, row| column > 1 && row > 0);
    for (column, row, pixel) in painted_white(&rgb, &mask).enumerate_pixels() {
        let expected = if column > 1 && row == 1 {
            [255; 3]
        } else {
            rgb.get_pixel(column, row).0
        };
        assert_eq!(pixel.0, expected, "({column}, {row})");
    }
}

#[test]
fn misread_white_is_a_green_and_grey_stays_almost_grey() {
    // Hue 255 halves of a degree is 150 degrees: green with half as much blue, which is then used as red.
    assert_eq!(misread([255; 3]), [127, 255, 0]);
    // Hue 80 degrees, saturation 40 of 255: value 40 and a little less.
    assert_eq!(misread([40; 3]), [33, 40, 37]);
}

/// Rows of 12 bytes: blue, green, red; hue (halves of degrees), saturation, value (255ths); three masks and
/// intermediate colours; last the grey of the colour.
#[test]
fn greys_and_misread_colors_are_opencvs_and_hues_differ_by_its_rounding_alone() {
    let test = "greys_and_misread_colors_are_opencvs_and_hues_differ_by_its_rounding_alone";
    let Some(root) = recorded_data(test) else {
        return;
    };
    let bytes = std::fs::read(root.join("vision/opencv_color_golden.npy")).unwrap();
    let rows: Vec<u8> = npyz::NpyFile::new(&bytes[..]).unwrap().into_vec().unwrap();
    let mut n_pink = 0;
    // Blocks of 32 colours; OpenCV rounded the last five.
    let n_cut_off = rows.len() / 12 / 32 * 32;
    for (number, row) in rows.chunks_exact(12).enumerate() {
        let rgb = [row[2], row[1], row[0]];
        assert_eq!(gray_level(rgb), row[11], "{rgb:?}");
        let [hue, saturation, value] = [row[3], row[4], row[5]].map(f64::from);
        // OpenCV rounds to these units, with tables that are off by up to a fifth of a unit; its 180 is 0.
        let hues = [hue - 0.7, hue + 0.7].map(|level| (2.0 * level).rem_euclid(360.0));
        let around = |level: f64| [(level - 0.55) / 255.0, (level + 0.55) / 255.0];
        assert!(
            is_in(rgb, hues, around(saturation), around(value)),
            "{rgb:?}: {row:?}"
        );
        // The paper's pink, with its limits moved midway between two of OpenCV's levels.
        let pink = |shrunk: f64| {
            let hue_deg = [279.0 + 0.4 * shrunk, 341.0 - 0.4 * shrunk];
            let saturation = [(49.5 + 0.05 * shrunk) / 255.0, 1.0];
            is_in(rgb, hue_deg, saturation, [74.5 / 255.0, 1.0])
        };
        let is_pink = row[6] > 0;
        assert!(!is_pink || pink(-1.0), "{rgb:?}: {row:?}");
        assert!(is_pink || !pink(1.0), "{rgb:?}: {row:?}");
        n_pink += usize::from(is_pink);
        let misread = misread(if is_pink { [255; 3] } else { rgb });
        if number < n_cut_off {
            assert_eq!(misread, [row[9], row[8], row[7]], "{rgb:?}");
            assert_eq!(gray_level(misread), row[10], "{rgb:?}");
        }
    }
    assert!(
        rows.len() >= 12 * 4000 && n_pink >= 100,
        "{n_pink} of {}",
        rows.len() / 12
    );
}
