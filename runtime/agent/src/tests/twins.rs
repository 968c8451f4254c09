//! Unit tests of `twins`.

#![allow(clippy::unwrap_used)]
use super::*;
use fab_picture::DepthImage;
use fab_program::{ImageUp, RECORDED_HEIGHT_M};
use image::Luma;

const SIDE_PX: u32 = 64;

/// What a cloth's pixels show of these heights above the table, metres, without depth where there is none.
fn raised_of(height_m: impl Fn(u32) -> Option<f32>) -> Option<f64> {
    let camera = fab_program::Camera {
        height_m: 0.65,
        fov_rad: 0.8,
        image_px: SIDE_PX,
        up: ImageUp::Y,
    };
    let depth_m = DepthImage::from_fn(SIDE_PX, SIDE_PX, |column, row| {
        Luma([height_m(row * SIDE_PX + column).map_or(0.0, |it| 0.65 - it)])
    });
    let rgb = RgbImage::new(SIDE_PX, SIDE_PX);
    let seen = Observation::of_picture(&camera, rgb, Some(depth_m)).unwrap();
    raised_m(&seen, &Mask::from_fn(SIDE_PX, SIDE_PX, |_, _| true))
}

#[test]
fn a_cameras_errors_raise_no_flat_cloth_and_a_heap_is_raised() {
    let noisy = |pixel: u32| 0.005 + (pixel * 7 % 13) as f32 / 1000.0 - 0.006;
    let flat = RECORDED_HEIGHT_M + RAISED_M;
    let outliers = |every: u32| {
        raised_of(move |pixel| match pixel % 100 < every {
            true => Some(0.06),
            false => Some(noisy(pixel)),
        })
        .unwrap()
    };
    assert!(raised_of(|pixel| Some(noisy(pixel))).unwrap() < flat);
    assert!(outliers(9) < flat && outliers(11) > flat);
    // Pixels without a reading say nothing.
    let half = raised_of(|pixel| (pixel % 2 == 0).then_some(0.02));
    assert!((half.unwrap() - 0.02).abs() < 1e-6);
    assert_eq!(raised_of(|_| None), None);
}
