//! Splits, closings and largest pieces on pictures whose answer is known.

use super::*;
use crate::largest;
use fab_program::PixelPoint;
use image::Rgb;
use proptest::prelude::*;

/// A picture of a table with a square of another colour from 20 to 39 on both axes.
fn square_on(table: [u8; 3], cloth: [u8; 3]) -> RgbImage {
    RgbImage::from_fn(64, 64, |column, row| {
        let is_cloth = (20..40).contains(&column) && (20..40).contains(&row);
        Rgb(if is_cloth { cloth } else { table })
    })
}

#[test]
fn a_dark_a_bright_and_a_coloured_cloth_are_told_from_the_table() {
    let cases = [
        (
            [230, 230, 230],
            [60, 60, 60],
            Channel::Brightness,
            Side::Low,
        ),
        (
            [90, 90, 90],
            [240, 240, 240],
            Channel::Brightness,
            Side::High,
        ),
        (
            [128, 128, 128],
            [205, 100, 100],
            Channel::Saturation,
            Side::High,
        ),
        (
            [200, 60, 60],
            [130, 130, 130],
            Channel::Saturation,
            Side::Low,
        ),
    ];
    for (table, cloth, of, keep) in cases {
        let found = split_mask(&square_on(table, cloth), of, keep, 1, 0.15);
        assert_eq!(found.area_px(), 400, "{table:?} {cloth:?}");
        assert!(found.contains(PixelPoint::new(20, 39)));
    }
}

#[test]
fn both_sides_together_are_the_picture() {
    let rgb = square_on([230, 230, 230], [60, 60, 60]);
    let of = |keep| split_mask(&rgb, Channel::Brightness, keep, 5, 0.0).area_px();
    assert_eq!(of(Side::Low) + of(Side::High), 64 * 64);
}

#[test]
fn what_hardly_differs_is_no_cloth() {
    let alike = square_on([200, 200, 200], [190, 190, 190]);
    let of = |contrast| split_mask(&alike, Channel::Brightness, Side::Low, 1, contrast);
    assert!(of(0.15).is_empty());
    assert_eq!(of(0.03).area_px(), 400);
    let contrast = contrast_of(&alike, Channel::Brightness, 1).expect("there are two levels");
    assert!((contrast - 10.0 / 255.0).abs() < 1e-12);
    let one = square_on([200, 200, 200], [200, 200, 200]);
    assert!(split_mask(&one, Channel::Brightness, Side::High, 1, 0.0).is_empty());
    assert_eq!(contrast_of(&one, Channel::Brightness, 1), None);
}

#[test]
fn a_cloth_with_a_bright_and_a_pale_side_is_one() {
    let rgb = RgbImage::from_fn(64, 64, |column, row| {
        let is_cloth = (20..40).contains(&column) && (20..40).contains(&row);
        Rgb(match (is_cloth, column < 30) {
            (false, _) => [243, 243, 246],
            (true, true) => [255, 113, 0],
            (true, false) => [245, 142, 200],
        })
    });
    let found = split_mask(&rgb, Channel::Saturation, Side::High, 1, 0.15);
    assert_eq!(found.area_px(), 400);
}

#[test]
fn specks_vanish_in_a_blur() {
    let mut rgb = square_on([230, 230, 230], [60, 60, 60]);
    rgb.put_pixel(5, 5, Rgb([0, 0, 0]));
    let of = |blur_px| split_mask(&rgb, Channel::Brightness, Side::Low, blur_px, 0.15);
    assert!(of(1).contains(PixelPoint::new(5, 5)));
    assert!(!of(9).contains(PixelPoint::new(5, 5)));
    assert!(of(9).contains(PixelPoint::new(30, 30)));
}

#[test]
fn a_blur_averages_over_what_the_picture_has() {
    let levels = [0, 90, 90, 90, 90, 90, 90, 90, 90];
    let blurred = blurred(&levels, [3, 3], 3);
    assert_eq!(blurred[4], 80);
    assert_eq!(blurred[0], 68, "three of four pixels at the corner");
    assert_eq!(blurred[8], 90);
}

#[test]
fn a_gap_is_filled_and_a_bay_that_is_wider_stays() {
    let with_gap = |gap: u32| {
        Mask::from_fn(64, 64, |column, row| {
            (10..50).contains(&row)
                && (10..50).contains(&column)
                && !(30..30 + gap).contains(&column)
        })
    };
    assert_eq!(closed(&with_gap(4), 5).area_px(), 40 * 40);
    assert_eq!(closed(&with_gap(4), 10).area_px(), 40 * 40);
    assert_eq!(closed(&with_gap(10), 10), with_gap(10));
}

#[test]
fn the_largest_piece_is_kept_whole() {
    let mask = Mask::from_fn(40, 40, |column, row| {
        (row < 5 && column < 5) || (row > 20 && column > 10) || (row == 12 && column == 30)
    });
    let found = largest(&mask);
    assert_eq!(found.area_px(), 19 * 29);
    assert_eq!(largest(&found), found);
    let none = Mask::from_fn(4, 4, |_, _| false);
    assert!(largest(&none).is_empty());
}

proptest! {
    #[test]
    fn closing_only_adds_and_a_second_time_changes_nothing(
        pixels in proptest::collection::vec(any::<bool>(), 24 * 17),
        side in 0_u32..9,
    ) {
        let mask = Mask::from_fn(24, 17, |column, row| pixels[(row * 24 + column) as usize]);
        let once = closed(&mask, side);
        prop_assert!(mask.pixels().all(|pixel| once.contains(pixel)));
        prop_assert_eq!(&closed(&once, side), &once);
    }

    #[test]
    fn no_picture_is_too_odd(
        side in 1_u32..20,
        bytes in proptest::collection::vec(any::<u8>(), 20 * 20 * 3),
        blur in 0_u32..40,
        contrast in -1.0_f64..2.0,
    ) {
        let rgb = RgbImage::from_fn(side, side, |column, row| {
            let at = ((row * side + column) * 3) as usize;
            Rgb([bytes[at], bytes[at + 1], bytes[at + 2]])
        });
        for (of, keep) in [(Channel::Brightness, Side::Low), (Channel::Saturation, Side::High)] {
            let mask = split_mask(&rgb, of, keep, blur, contrast);
            prop_assert_eq!(mask.width(), side);
            prop_assert!(mask.area_px() <= (side * side) as usize);
        }
    }
}
