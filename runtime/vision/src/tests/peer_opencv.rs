//! OpenCV finds in drawn shapes what is found without it. tests/suite/peer_opencv.rs has scenes of cloths.

use super::harris;
use crate::primitives::{by_opencv, own};
use crate::{CornerSearch, Rectangle, largest};
use fab_picture::{Mask, mask_picture};
use fab_program::Response;
use image::{GrayImage, Luma};

/// Numbers from 0 to 1 that a seed begins (Marsaglia 2003).
fn chance(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Draws overlapping slanted bars, with some pixels flipped.
fn blot(seed: u64) -> Mask {
    let mut chance = chance(seed);
    let n_bars = 3 + (chance() * 8.0) as usize;
    let side = 40.0 + chance() * 200.0;
    let bars: Vec<[f64; 5]> = (0..n_bars)
        .map(|_| {
            let [x, y] = [(); 2].map(|()| chance() * side);
            let [long, wide] = [(); 2].map(|()| (0.05 + 0.3 * chance()) * side);
            [x, y, long, wide, chance() * std::f64::consts::TAU]
        })
        .collect();
    let noise = chance() * 0.05;
    Mask::from_fn(side as u32, side as u32 - 5, |column, row| {
        let is_bar = bars.iter().any(|[x, y, long, wide, angle]| {
            let (right, down) = (f64::from(column) - x, f64::from(row) - y);
            let (sin, cos) = angle.sin_cos();
            (right * cos + down * sin).abs() < *long && (down * cos - right * sin).abs() < *wide
        });
        is_bar != (chance() < noise)
    })
}

fn grey(seed: u64, picture: &GrayImage) -> GrayImage {
    let mut chance = chance(seed);
    GrayImage::from_fn(picture.width(), picture.height(), |column, row| {
        let level = f64::from(picture.get_pixel(column, row).0[0]);
        Luma([(level / 2.0 + 100.0 * chance()) as u8])
    })
}

#[test]
#[ignore = "needs OpenCV"]
fn peer_opencv_finds_the_same_in_drawn_shapes() {
    for seed in 1..400 {
        let mask = largest(&blot(seed));
        let outline = own::outer_outline(&mask).unwrap();
        assert_eq!(outline, by_opencv::outer_outline(&mask).unwrap(), "{seed}");
        for tolerance_px in [0.5, 1.0, 2.5, 3.0, 8.0, 40.0, 500.0] {
            let [ours, theirs] = [own::simplified, by_opencv::simplified]
                .map(|simplified| simplified(&outline, tolerance_px).unwrap());
            assert_eq!(ours, theirs, "{seed}, {tolerance_px} px");
        }
        let [ours, theirs] = [own::smallest_rectangle, by_opencv::smallest_rectangle]
            .map(|smallest| smallest(&outline).unwrap());
        let sorted = |mut sides: [f64; 2]| {
            sides.sort_by(f64::total_cmp);
            sides
        };
        let numbers = |found: Rectangle| [found.center, sorted(found.sides)].concat();
        for (ours, theirs) in numbers(ours).into_iter().zip(numbers(theirs)) {
            assert!((ours - theirs).abs() < 0.01, "{seed}");
        }
        let shape = mask_picture(&mask);
        let noisy = grey(seed, &shape);
        for (picture, block_px, response) in [
            (&shape, 3, Response::Harris { k: 0.04 }),
            (&noisy, 3, Response::Harris { k: 0.06 }),
            (&shape, 5, Response::ShiTomasi),
            (&noisy, 7, Response::ShiTomasi),
        ] {
            let search = CornerSearch {
                block_px,
                response,
                ..harris()
            };
            let found = own::strong_corners(picture, &search).unwrap();
            assert_eq!(
                found,
                by_opencv::strong_corners(picture, &search).unwrap(),
                "{seed}"
            );
            for half_px in [2, 4, 7] {
                let [ours, theirs] = [own::refine_corners, by_opencv::refine_corners]
                    .map(|refine| refine(picture, &found, half_px).unwrap());
                assert_eq!(ours, theirs, "{seed}, {half_px} px");
            }
        }
    }
}
