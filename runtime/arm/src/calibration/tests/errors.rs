//! Tests that fits are exact without errors, and that errors propagate as the spread predicts.

use super::super::accuracy::measure;
use super::super::fit::{error, fit, sightings};
use super::*;
use fab_picture::camera::Plane;
use proptest::prelude::*;

/// The fit of points, without judging it.
fn fitted(truth: &Truth, pairs: &[Pair]) -> Plane {
    fit(&truth.lens, &sightings(&truth.lens, pairs).unwrap()).unwrap()
}

/// The error of a fit at a point, millimetres along the axes of the base.
fn error_mm(truth: &Truth, fit: &Plane, pair: &Pair) -> Vector3<f64> {
    let points = sightings(&truth.lens, &[*pair]).unwrap();
    error(fit, &points[0]).unwrap() * 1000.0
}

/// Two rows of eight points across the picture, at the given distance in millimetres.
fn two_rows(truth: &Truth, apart_mm: f64) -> Vec<Pair> {
    // At a metre and a focal length of 600 px, a millimetre is 0.6 px.
    let rows = [-0.3, 0.3].map(|side| 240.0 + side * apart_mm);
    let columns = (0..8).map(|column| 120.0 + 400.0 * f64::from(column) / 7.0);
    let places = rows
        .into_iter()
        .flat_map(|v| columns.clone().map(move |u| [u, v]));
    places.map(|pixel| truth.pair(pixel)).collect()
}

/// Root mean square and largest error over the reachable part of the window: in the plane, and in height.
#[derive(Debug, Default)]
struct Errors {
    plane_rms_mm: f64,
    plane_most_mm: f64,
    height_most_mm: f64,
}

/// Calibrates a hundred times with errors of 1 mm and half a pixel, and measures the whole table.
fn errors(truth: &Truth, pairs: &[Pair]) -> Errors {
    let mut noise = Noise::new(3);
    let mut errors = Errors::default();
    let mut n = 0.0;
    let [least, most] = terms().reach_m;
    let places: Vec<Pair> = (0..81)
        .map(|it| window().pixel_at([f64::from(it % 9) / 8.0, f64::from(it / 9) / 8.0]))
        .map(|pixel| truth.pair(pixel))
        .filter(|it| (0..2).all(|axis| (least[axis]..=most[axis]).contains(&it.base_m[axis])))
        .collect();
    for _ in 0..100 {
        let measured = pairs.iter().map(|pair| noise.measured(pair, 0.001, 0.5));
        let fit = fitted(truth, &measured.collect::<Vec<Pair>>());
        for place in &places {
            let off_mm = error_mm(truth, &fit, place);
            let plane = off_mm.xy().norm();
            errors.plane_rms_mm += plane * plane;
            errors.plane_most_mm = errors.plane_most_mm.max(plane);
            errors.height_most_mm = errors.height_most_mm.max(off_mm.z.abs());
            n += 1.0;
        }
    }
    errors.plane_rms_mm = (errors.plane_rms_mm / n).sqrt();
    errors
}

#[test]
fn points_without_error_give_the_truth() {
    let truth = Truth::usual();
    let made = make(terms(), truth.grid(4, 0.8)).unwrap();
    assert!(made.accuracy.rms_mm < 1e-6, "{:?}", made.accuracy);
    assert!(made.accuracy.left_out_rms_mm < 1e-6, "{:?}", made.accuracy);
    for share in [[0.0, 0.0], [1.0, 0.1], [0.3, 0.9]] {
        let pixel = window().pixel_at(share);
        let shown = made.fit.world_from_pixel(pixel).unwrap();
        assert!((shown - truth.table(pixel)).norm() < 1e-8, "{shown}");
        let [u, v] = made.fit.pixel_from_world(shown).unwrap();
        assert!((u - pixel[0]).hypot(v - pixel[1]) < 1e-6);
    }
    assert!((tilt_deg(&made.fit) - 0.243).abs() < 1e-3);
    assert!((made.table_height_m([0.45, 0.0]) - 0.02135).abs() < 1e-8);
    // Every comparison with the stated camera is exact as well, but for the direction, which is stated in whole degrees.
    for check in &made.accuracy.checks {
        let is_exact = check.value < 1e-3
            || matches!(
                check.name,
                "plane_gain" | "height_gain" | "up_deg" | "corner_mm"
            );
        assert!(
            is_exact || check.name == "camera_height_percent" && check.value < 0.1,
            "{check:?}"
        );
    }
}

#[test]
fn a_grid_of_four_by_four_is_good_to_a_millimetre_in_the_plane() {
    let truth = Truth::usual();
    let found = errors(&truth, &truth.grid(4, 0.8));
    assert!((0.7..1.1).contains(&found.plane_rms_mm), "{found:?}");
    assert!(found.height_most_mm < 2.5, "{found:?}");
}

/// Returns the names of the values beyond their bounds.
fn beyond(refusal: &Refusal) -> Vec<&str> {
    let name = |fault: &Fault| match fault {
        Fault::Beyond(check) => check.name,
        fault => panic!("{fault}"),
    };
    refusal.faults.iter().map(name).collect()
}

#[test]
fn two_rows_close_together_are_centimetres_off_and_are_refused() {
    let truth = Truth::usual();
    let pairs = two_rows(&truth, 25.0);
    let found = errors(&truth, &pairs);
    assert!((35.0..80.0).contains(&found.plane_most_mm), "{found:?}");
    // They fit as well as any others, so no limit on errors catches this.
    let refusal = make(terms(), pairs).unwrap_err();
    assert_eq!(beyond(&refusal), ["plane_gain", "height_gain"], "{refusal}");
    assert!(make(terms(), two_rows(&truth, 300.0)).is_ok());
}

#[test]
#[ignore = "long"]
fn the_gain_is_what_errors_come_to() {
    let truth = Truth::usual();
    for share in [0.5, 0.8] {
        let mut terms = terms();
        terms.reach_m = [[-2.0; 2], [2.0; 2]];
        let pairs = truth.grid(4, share);
        let points = sightings(&truth.lens, &pairs).unwrap();
        let fit = fitted(&truth, &pairs);
        let said = measure(&terms, &truth.lens, &fit, &points).unwrap().spread;
        // A corner of the window is the worst place, or as bad as the worst.
        let corner = truth.pair(window().pixel_at([0.0, 1.0]));
        let (mut noise, mut off) = (Noise::new(7), Vec::new());
        for _ in 0..2000 {
            let measured = pairs.iter().map(|it| noise.measured(it, 0.001, 0.0));
            let fit = fitted(&truth, &measured.collect::<Vec<Pair>>());
            off.push(error_mm(&truth, &fit, &corner));
        }
        let n = off.len() as f64;
        let spread: nalgebra::Matrix2<f64> = off
            .iter()
            .map(|it| it.xy() * it.xy().transpose())
            .sum::<nalgebra::Matrix2<f64>>()
            / n;
        let plane = spread.symmetric_eigenvalues().max().sqrt();
        let height = (off.iter().map(|it| it.z * it.z).sum::<f64>() / n).sqrt();
        assert!(
            plane <= said.plane_gain * 1.1 && plane > said.plane_gain * 0.6,
            "{share} {plane} {said:?}"
        );
        assert!(
            height <= said.height_gain * 1.1 && height > said.height_gain * 0.6,
            "{share} {height} {said:?}"
        );
    }
}

#[test]
fn no_homography_nearby_fits_better() {
    let mut noise = Noise::new(4);
    let mut truth = Truth::usual();
    // In a slanted view, the linear equations weigh far points less.
    truth.base_from_camera *= Isometry3::rotation(Vector3::new(0.5, 0.2, 0.0));
    let grid = truth.grid(4, 0.8);
    let measured: Vec<Pair> = grid
        .iter()
        .map(|pair| noise.measured(pair, 0.004, 0.0))
        .collect();
    let cost = |fit: &Plane| -> f64 {
        let error = |pair| error_mm(&truth, fit, pair).xy().norm_squared();
        measured.iter().map(error).sum()
    };
    let fit = fitted(&truth, &measured);
    let least = cost(&fit);
    for entry in 0..8 {
        for share in [-1e-6, 1e-6] {
            let mut other = fit;
            other.world_from_pixel[entry] *= 1.0 + share;
            assert!(cost(&other) > least, "entry {entry}");
        }
    }
}

#[test]
fn only_what_the_arm_reaches_has_to_be_covered() {
    let truth = Truth::usual();
    let mut terms = terms();
    let left = |right: f64, down: f64| truth.pair(window().pixel_at([right, down]));
    let pairs: Vec<Pair> = (0..12)
        .map(|index| {
            left(
                0.08 + 0.16 * f64::from(index % 3),
                0.1 + 0.26 * f64::from(index / 3),
            )
        })
        .collect();
    let refusal = make(terms.clone(), pairs.clone()).unwrap_err();
    assert!(beyond(&refusal).contains(&"plane_gain"), "{refusal}");
    // The left of the picture is where y is large.
    terms.reach_m[0][1] = 0.0;
    let made = make(terms, pairs);
    assert!(made.is_ok(), "{}", made.unwrap_err());
}

#[test]
fn a_limit_is_kept_and_may_be_raised() {
    let truth = Truth::usual();
    let mut noise = Noise::new(5);
    let grid = truth.grid(4, 0.8);
    let pairs = grid.iter().map(|it| noise.measured(it, 0.004, 0.5));
    let pairs: Vec<Pair> = pairs.collect();
    let mut terms = terms();
    let refusal = make(terms.clone(), pairs.clone()).unwrap_err();
    assert_eq!(
        beyond(&refusal)[..2],
        ["rms_mm", "left_out_mm"],
        "{refusal}"
    );
    assert!(refusal.fit.is_some());
    terms.limit_mm = 10.0;
    let made = make(terms.clone(), pairs.clone()).unwrap();
    assert!((4.0..8.0).contains(&made.accuracy.rms_mm), "{made:?}");
    assert!(made.accuracy.left_out_rms_mm > made.accuracy.rms_mm);
    for limit_mm in [0.0, -1.0, f64::NAN, 21.0] {
        terms.limit_mm = limit_mm;
        let refusal = make(terms.clone(), pairs.clone()).unwrap_err();
        assert!(
            matches!(refusal.faults[..], [Fault::Limit { .. }]),
            "{refusal}"
        );
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
        let mut terms = truth.terms();
        terms.reach_m = [[-2.0; 2], [2.0; 2]];
        let made = make(terms, truth.grid(4, 0.8)).unwrap();
        for share in [[0.02, 0.02], [0.9, 0.1], [0.4, 0.97]] {
            let pixel = window().pixel_at(share);
            let shown = made.table_from_pixel(pixel).unwrap();
            prop_assert!((shown - truth.table(pixel)).norm() < 1e-6);
        }
    }
}
