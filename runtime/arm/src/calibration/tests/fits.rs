//! Tests that fits are exact without errors, and that the stated errors are those of noisy points.

use super::*;
use fab_picture::camera::Plane;
use proptest::prelude::*;

#[test]
fn points_without_error_give_the_truth() {
    let truth = Truth::usual();
    let made = make(truth.grid(4, 0.8)).unwrap();
    assert!(made.left_out_rms_mm() < 1e-6, "{:?}", made.left_out_mm);
    for share in [[0.0, 0.0], [1.0, 0.1], [0.3, 0.9]] {
        let pixel = pixel_at(WINDOW, share);
        let shown = made.fit.world_from_pixel(pixel).unwrap();
        assert!((shown - truth.table(pixel)).norm() < 1e-8, "{shown}");
        let [u, v] = made.fit.pixel_from_world(shown).unwrap();
        assert!((u - pixel[0]).hypot(v - pixel[1]) < 1e-6);
    }
    assert!((made.table_height_m([0.45, 0.0]) - 0.02135).abs() < 1e-8);
    for corner in made.over_table(&settings()).unwrap() {
        assert!(corner.error_mm < 1e-6, "{corner:?}");
    }
}

/// A hundred calibrations with errors of 1 mm and half a pixel, and the true errors at the window's corners.
#[test]
fn careful_calibrations_are_accepted_and_say_how_good_they_are() {
    let truth = Truth::usual();
    let grid = truth.grid(4, 0.8);
    let (mut n, mut stated, mut found) = (0.0, 0.0, 0.0);
    for seed in 1..=100 {
        let mut noise = Noise::new(seed);
        let pairs = grid.iter().map(|pair| noise.measured(pair, 0.001, 0.5));
        let made = make(pairs.collect()).unwrap_or_else(|refusal| panic!("{seed}: {refusal}"));
        // 1 mm along each axis, and 0.8 mm along two of them for half a pixel.
        let left_out_mm = made.left_out_rms_mm();
        assert!((1.4..4.0).contains(&left_out_mm), "{seed}: {left_out_mm}");
        let corners = made.over_table(&settings());
        for corner in corners.unwrap_or_else(|refusal| panic!("{seed}: {refusal}")) {
            let at = made.fit.pixel_from_world(corner.at_m.into()).unwrap();
            let off_mm = (truth.table(at) - Point3::from(corner.at_m)).norm() * 1000.0;
            (n, stated, found) = (
                n + 1.0,
                stated + corner.error_mm * corner.error_mm,
                found + off_mm * off_mm,
            );
        }
    }
    let [stated, found] = [stated, found].map(|sum: f64| (sum / n).sqrt());
    assert!(
        (0.8..1.4).contains(&(stated / found)),
        "{stated} for {found} mm"
    );
}

#[test]
fn no_homography_nearby_fits_better() {
    let mut noise = Noise::new(4);
    let mut truth = Truth::usual();
    // In a slanted view, the linear equations weigh far points less.
    truth.base_from_camera *= Isometry3::rotation(Vector3::new(0.5, 0.2, 0.0));
    let grid = truth.grid(4, 0.8);
    let measured = grid.iter().map(|pair| noise.measured(pair, 0.004, 0.0));
    let measured: Vec<Pair> = measured.collect();
    let cost = |fit: &Plane| -> f64 {
        let off_m = |pair: &Pair| {
            let shown = fit.world_from_pixel(pair.pixel).unwrap();
            (shown - Point3::from(pair.base_m)).xy().norm_squared()
        };
        measured.iter().map(off_m).sum()
    };
    let fit = truth.terms().fit(&measured).unwrap();
    let least = cost(&fit);
    for entry in 0..8 {
        for share in [-1e-3, 1e-3] {
            let mut other = fit;
            other.world_from_pixel[entry] *= 1.0 + share;
            assert!(cost(&other) > least, "entry {entry}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_camera_above_the_table_is_found(
        turn in 0.0..6.2_f64,
        tilt in prop::array::uniform2(-0.25..0.25_f64),
        place in prop::array::uniform2(-0.1..0.1_f64),
        height in 0.7..1.4_f64,
        k1 in -0.1..0.1_f64,
        level in prop::array::uniform3(-0.005..0.005_f64),
    ) {
        let mut truth = Truth::usual();
        truth.base_from_camera = Isometry3::translation(0.45 + place[0], place[1], height)
            * Isometry3::rotation(Vector3::new(0.0, 0.0, turn))
            * Isometry3::rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0))
            * Isometry3::rotation(Vector3::new(tilt[0], tilt[1], 0.0));
        truth.lens.distortion = [k1, 0.0, 0.001, -0.001, 0.0];
        truth.height = level;
        let pairs = truth.grid(4, 0.8);
        let made = Calibration::make(truth.terms(), pairs, "2026-11-22", None).unwrap();
        for share in [[0.02, 0.02], [0.9, 0.1], [0.4, 0.97]] {
            let pixel = pixel_at(WINDOW, share);
            let shown = made.table_from_pixel(pixel).unwrap();
            prop_assert!((shown - truth.table(pixel)).norm() < 1e-6);
        }
    }
}
