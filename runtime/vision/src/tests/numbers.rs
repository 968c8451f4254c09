//! Tests of the numbers beside points: which digits are drawn, and what they leave free.

use super::super::draw_numbers;
use image::{Rgb, RgbImage};
use proptest::prelude::*;

const GREY: Rgb<u8> = Rgb([128, 128, 128]);

fn table(width: u32, height: u32) -> RgbImage {
    RgbImage::from_pixel(width, height, GREY)
}

/// Writes a picture as letters: `#` bright, `o` dark, `.` unchanged.
fn letters(picture: &RgbImage) -> Vec<String> {
    picture
        .rows()
        .map(|row| {
            row.map(|pixel| match pixel.0[0] {
                129.. => '#',
                ..128 => 'o',
                128 => '.',
            })
            .collect()
        })
        .collect()
}

#[test]
fn a_number_stands_beside_its_point_in_white_with_a_black_rim() {
    let mut picture = table(24, 24);
    draw_numbers(&mut picture, &[[2.5, 20.5]]);
    let expected = [
        ".........oooooo.........",
        ".........ooo#oo.........",
        ".........o###oo.........",
        ".........ooo#oo.........",
        ".........ooo#oo.........",
        "...........o#oo.........",
        "...........o#oo.........",
        "...........o#oo.........",
        ".........ooo#oooo.......",
        ".........oo####oo.......",
        ".........oooooooo.......",
    ];
    let drawn = letters(&picture);
    let drawn: Vec<&String> = drawn
        .iter()
        .filter(|row| row.contains(['#', 'o']))
        .collect();
    assert_eq!(drawn, expected);
}

#[test]
fn digits_grow_with_the_picture_and_differ() {
    let n_white = |side: u32, n_points: usize| {
        let mut picture = table(side, side);
        let places: Vec<[f64; 2]> = (0..n_points)
            .map(|number| [30.0, 20.0 + 38.0 * number as f64])
            .collect();
        draw_numbers(&mut picture, &places);
        picture.pixels().filter(|pixel| pixel.0[0] > 220).count()
    };
    assert!(n_white(224, 1) < n_white(720, 1) && n_white(720, 1) < n_white(900, 1));
    let growth: Vec<usize> = (1..=10).map(|n| n_white(399, n)).collect();
    assert!(
        growth.windows(2).all(|pair| pair[0] < pair[1]),
        "{growth:?}"
    );
}

#[test]
fn a_place_outside_of_the_picture_has_no_number() {
    let mut picture = table(60, 60);
    let outside = [
        [f64::NAN, 30.0],
        [30.0, f64::INFINITY],
        [-0.5, 30.0],
        [60.0, 30.0],
        [1e300, -1e300],
    ];
    draw_numbers(&mut picture, &outside);
    assert_eq!(picture, table(60, 60));
    draw_numbers(&mut RgbImage::new(0, 0), &[[0.0, 0.0]]);
    draw_numbers(&mut table(3, 3), &[[1.0, 1.0]]);
}

#[test]
fn the_501st_place_has_no_number() {
    let [mut most, mut more] = [table(300, 300), table(300, 300)];
    let places: Vec<[f64; 2]> = (0..501)
        .map(|at| [f64::from(at % 25) * 12.0, f64::from(at / 25) * 14.0])
        .collect();
    draw_numbers(&mut most, &places[..500]);
    draw_numbers(&mut more, &places);
    assert_eq!(most, more);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn numbers_cover_no_point_and_stay_in_the_picture(
        side in 100_u32..500, at in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 1..14),
    ) {
        let mut picture = table(side, side);
        let places: Vec<[f64; 2]> = at
            .iter()
            .map(|(x, y)| [x * f64::from(side), y * f64::from(side)])
            .collect();
        draw_numbers(&mut picture, &places);
        let changed = picture.pixels().filter(|pixel| **pixel != GREY).count();
        prop_assert!(changed >= 20);
        for [column, row] in places {
            let (column, row) = (column as u32, row as u32);
            for (x, y) in [(0, 0), (1, 0), (0, 1), (2, 2)] {
                let (x, y) = ((column + x).min(side - 1), (row + y).min(side - 1));
                prop_assert_eq!(*picture.get_pixel(x, y), GREY);
            }
        }
    }
}
