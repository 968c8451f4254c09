//! Tests that fits are exact without errors, and that errors propagate as the spread predicts.

use super::super::fit::Solver;
use super::super::spread;
use super::*;
use proptest::prelude::*;

const METHODS: [Method; 2] = [Method::Plane, Method::Rigid];

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
    height_rms_mm: f64,
    height_most_mm: f64,
}

/// Calibrates a hundred times with errors of 1 mm, half a pixel, and 2 mm in depth, and measures the whole table.
fn errors(truth: &Truth, method: Method, pairs: &[Pair]) -> Errors {
    let terms = terms(method);
    let solver = Solver::of(&terms).unwrap();
    let mut noise = Noise::new(3);
    let mut errors = Errors::default();
    let mut n = 0.0;
    let [least, most] = terms.reach_m;
    let places: Vec<Pair> = (0..81)
        .map(|it| window().pixel_at([f64::from(it % 9) / 8.0, f64::from(it / 9) / 8.0]))
        .map(|pixel| truth.pair(pixel))
        .filter(|it| (0..2).all(|axis| (least[axis]..=most[axis]).contains(&it.base_m[axis])))
        .collect();
    for _ in 0..100 {
        let measured: Vec<Pair> = pairs
            .iter()
            .map(|pair| noise.measured(pair, 0.001, 0.5, 0.002))
            .collect();
        let fit = solver.fit(&solver.sightings(&measured).unwrap()).unwrap();
        for place in &places {
            let off_mm = fit.error(&solver.sighting(place).unwrap()).unwrap() * 1000.0;
            let (plane, height) = (off_mm.xy().norm(), off_mm.z.abs());
            errors.plane_rms_mm += plane * plane;
            errors.height_rms_mm += height * height;
            errors.plane_most_mm = errors.plane_most_mm.max(plane);
            errors.height_most_mm = errors.height_most_mm.max(height);
            n += 1.0;
        }
    }
    errors.plane_rms_mm = (errors.plane_rms_mm / n).sqrt();
    errors.height_rms_mm = (errors.height_rms_mm / n).sqrt();
    errors
}

#[test]
fn points_without_error_give_the_truth() {
    let truth = Truth::usual();
    for method in METHODS {
        let made =
            Calibration::make(terms(method), truth.grid(4, 0.8), "2026-11-22", None).unwrap();
        assert!(made.accuracy.rms_mm < 1e-6, "{:?}", made.accuracy);
        assert!(made.accuracy.left_out_rms_mm < 1e-6, "{:?}", made.accuracy);
        for share in [[0.0, 0.0], [1.0, 0.1], [0.3, 0.9]] {
            let pair = truth.pair(window().pixel_at(share));
            let shown = made.fit.table_from_pixel(pair.pixel).unwrap();
            let off = shown - Point3::from(pair.base_m);
            assert!(off.norm() < 1e-8, "{method:?} {off}");
            let [u, v] = made.fit.pixel_from_base(shown).unwrap();
            assert!((u - pair.pixel[0]).hypot(v - pair.pixel[1]) < 1e-6);
        }
        assert!((made.fit.tilt_deg() - 0.334).abs() < 1e-3);
        assert!((made.table_height_m([0.45, 0.0]) - 0.02225).abs() < 1e-8);
    }
}

#[test]
fn a_grid_of_four_by_four_is_good_to_a_millimetre_in_the_plane() {
    let truth = Truth::usual();
    let pairs = truth.grid(4, 0.8);
    let by_plane = errors(&truth, Method::Plane, &pairs);
    assert!((0.7..1.1).contains(&by_plane.plane_rms_mm), "{by_plane:?}");
    assert!(by_plane.height_most_mm < 2.5, "{by_plane:?}");
    let by_depth = errors(&truth, Method::Rigid, &pairs);
    assert!((0.4..1.0).contains(&by_depth.plane_rms_mm), "{by_depth:?}");
    assert!(by_depth.height_most_mm < 5.0, "{by_depth:?}");
}

#[test]
fn two_rows_close_together_are_centimetres_off_in_height_and_are_refused() {
    let truth = Truth::usual();
    let pairs = two_rows(&truth, 25.0);
    let by_depth = errors(&truth, Method::Rigid, &pairs);
    assert!(
        (25.0..45.0).contains(&by_depth.height_most_mm),
        "{by_depth:?}"
    );
    let by_plane = errors(&truth, Method::Plane, &pairs);
    assert!(
        (35.0..80.0).contains(&by_plane.plane_most_mm),
        "{by_plane:?}"
    );
    for method in METHODS {
        // They fit as well as any others, so no limit on errors catches this.
        let refusal =
            Calibration::make(terms(method), pairs.clone(), "2026-11-22", None).unwrap_err();
        assert!(
            matches!(refusal.faults[..], [Fault::Spread { .. }]),
            "{refusal}"
        );
        let apart = two_rows(&truth, 300.0);
        assert!(Calibration::make(terms(method), apart, "2026-11-22", None).is_ok());
    }
}

#[test]
#[ignore = "long"]
fn the_gain_is_what_errors_come_to() {
    let truth = Truth::usual();
    for (method, share) in [
        (Method::Plane, 0.5),
        (Method::Plane, 0.8),
        (Method::Rigid, 0.6),
    ] {
        let mut terms = terms(method);
        terms.reach_m = [[-2.0; 2], [2.0; 2]];
        let solver = Solver::of(&terms).unwrap();
        let pairs = truth.grid(4, share);
        let points = solver.sightings(&pairs).unwrap();
        let said = spread::measure(&terms, &solver.fit(&points).unwrap(), &points).unwrap();
        // A corner of the window is the worst place, or as bad as the worst.
        let corner = truth.pair(window().pixel_at([0.0, 1.0]));
        let (mut noise, mut off) = (Noise::new(7), Vec::new());
        for _ in 0..2000 {
            let measured: Vec<Pair> = pairs
                .iter()
                .map(|it| noise.measured(it, 0.001, 0.0, 0.0))
                .collect();
            let fit = solver.fit(&solver.sightings(&measured).unwrap()).unwrap();
            off.push(fit.error(&solver.sighting(&corner).unwrap()).unwrap() * 1000.0);
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
            "{method:?} {plane} {said:?}"
        );
        assert!(
            height <= said.height_gain * 1.1 && height > said.height_gain * 0.6,
            "{method:?} {height} {said:?}"
        );
    }
}

#[test]
fn no_homography_nearby_fits_better() {
    let terms = terms(Method::Plane);
    let solver = Solver::of(&terms).unwrap();
    let mut noise = Noise::new(4);
    let mut truth = Truth::usual();
    // In a slanted view, the linear equations weigh far points less.
    truth.base_from_camera *= Isometry3::rotation(Vector3::new(0.5, 0.2, 0.0));
    let grid = truth.grid(4, 0.8);
    let measured: Vec<Pair> = grid
        .iter()
        .map(|pair| noise.measured(pair, 0.004, 0.0, 0.0))
        .collect();
    let points = solver.sightings(&measured).unwrap();
    let cost = |fit: &Fit| -> f64 {
        let error = |point| fit.error(point).unwrap().xy().norm_squared();
        points.iter().map(error).sum()
    };
    let fit = solver.fit(&points).unwrap();
    let least = cost(&fit);
    for entry in 0..8 {
        for share in [-1e-6, 1e-6] {
            let mut other = fit.clone();
            if let Fit::Plane {
                base_from_pixel, ..
            } = &mut other
            {
                base_from_pixel[entry] *= 1.0 + share;
            }
            assert!(cost(&other) > least, "entry {entry}");
        }
    }
}

#[test]
fn only_what_the_arm_reaches_has_to_be_covered() {
    let truth = Truth::usual();
    let mut terms = terms(Method::Plane);
    let left = |right: f64, down: f64| truth.pair(window().pixel_at([right, down]));
    let pairs: Vec<Pair> = (0..12)
        .map(|index| {
            left(
                0.08 + 0.16 * f64::from(index % 3),
                0.1 + 0.26 * f64::from(index / 3),
            )
        })
        .collect();
    let refusal = Calibration::make(terms.clone(), pairs.clone(), "2026-11-22", None).unwrap_err();
    assert!(
        matches!(refusal.faults[..], [Fault::Spread { .. }]),
        "{refusal}"
    );
    // The left of the picture is where y is large.
    terms.reach_m[0][1] = 0.0;
    let made = Calibration::make(terms, pairs, "2026-11-22", None);
    assert!(made.is_ok(), "{}", made.unwrap_err());
}

#[test]
fn a_limit_is_kept_and_may_be_raised() {
    let truth = Truth::usual();
    let mut noise = Noise::new(5);
    let pairs: Vec<Pair> = truth
        .grid(4, 0.8)
        .iter()
        .map(|it| noise.measured(it, 0.004, 0.5, 0.0))
        .collect();
    let mut terms = terms(Method::Plane);
    let refusal = Calibration::make(terms.clone(), pairs.clone(), "2026-11-22", None).unwrap_err();
    assert!(
        matches!(refusal.faults[..], [Fault::Inaccurate { .. }]),
        "{refusal}"
    );
    assert!(refusal.fit.is_some());
    terms.limit_mm = 10.0;
    let made = Calibration::make(terms.clone(), pairs.clone(), "2026-11-22", None).unwrap();
    assert!(
        (4.0..8.0).contains(&made.accuracy.rms_mm),
        "{:?}",
        made.accuracy
    );
    assert!(made.accuracy.left_out_rms_mm > made.accuracy.rms_mm);
    for limit_mm in [0.0, -1.0, f64::NAN, 21.0] {
        terms.limit_mm = limit_mm;
        let refusal =
            Calibration::make(terms.clone(), pairs.clone(), "2026-11-22", None).unwrap_err();
        assert!(
            matches!(refusal.faults[..], [Fault::Limit { .. }]),
            "{refusal}"
        );
    }
}

#[test]
fn depth_of_another_scale_is_told_from_depth_that_scatters() {
    let truth = Truth::usual();
    let mut pairs = truth.grid(4, 0.8);
    let made = Calibration::make(terms(Method::Rigid), pairs.clone(), "2026-11-22", None).unwrap();
    let Fit::Rigid { scale, .. } = made.fit else {
        unreachable!("rigid")
    };
    assert!((scale - 1.0).abs() < 1e-9);
    for pair in &mut pairs {
        pair.depth_m = pair.depth_m.map(|depth| depth * 1.05);
    }
    let mut terms = terms(Method::Rigid);
    terms.limit_mm = 20.0;
    let refusal = Calibration::make(terms, pairs, "2026-11-22", None).unwrap_err();
    assert!(
        matches!(refusal.faults[..], [Fault::Scale { scale }] if (scale - 1.05).abs() < 1e-6),
        "{refusal}"
    );
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
        level in prop::array::uniform3(-0.02..0.02_f64),
    ) {
        let mut truth = Truth::usual();
        truth.base_from_camera = Isometry3::translation(0.45 + place[0], place[1], height)
            * Isometry3::rotation(Vector3::new(0.0, 0.0, turn))
            * Isometry3::rotation(Vector3::new(std::f64::consts::PI, 0.0, 0.0))
            * Isometry3::rotation(Vector3::new(tilt[0], tilt[1], 0.0));
        truth.lens.distortion = [k1, 0.0, 0.001, -0.001, 0.0];
        truth.height = level;
        for method in METHODS {
            let mut terms = terms(method);
            terms.intrinsics = Some(truth.intrinsics());
            terms.reach_m = [[-2.0; 2], [2.0; 2]];
            let made = Calibration::make(terms, truth.grid(4, 0.8), "2026-11-22", None).unwrap();
            for share in [[0.02, 0.02], [0.9, 0.1], [0.4, 0.97]] {
                let pair = truth.pair(window().pixel_at(share));
                let shown = made.table_from_pixel(pair.pixel).unwrap();
                prop_assert!((shown - Point3::from(pair.base_m)).norm() < 1e-6, "{method:?}");
            }
        }
    }
}
