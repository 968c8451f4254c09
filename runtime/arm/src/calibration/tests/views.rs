//! Tests that the camera of the tasks' picture agrees with the calibration at every point.

use super::*;
use proptest::prelude::*;

#[test]
fn windows_lie_in_their_picture() {
    for (window, is_in) in [
        ([80, 0, 480], true),
        ([161, 0, 480], false),
        ([0, 1, 480], false),
        ([0, 0, 0], false),
        ([u32::MAX, 0, 480], false),
    ] {
        let checked = check_window(window, [640, 480]);
        assert_eq!(checked.is_ok(), is_in, "{window:?}");
    }
    let error = check_window([200, 0, 480], [640, 480]).unwrap_err();
    assert!(
        error.contains("`200, 0, 480` does not lie in the camera's picture of 640 x 480 px"),
        "{error}"
    );
}

type Edit = fn(&mut Settings);

#[test]
fn settings_that_disagree_with_the_calibration_are_refused() {
    let made = make(measured_grid(11, 4, 0.8)).unwrap();
    made.over_table(&settings()).unwrap();
    let cases: [(Edit, &str); 4] = [
        (
            |it| it.table.center_m[2] += 0.1,
            "mm from the height in `table.center_m`; at most 10 mm",
        ),
        (
            |it| it.table.center_m[0] -= 0.15,
            "151 mm from `table.center_m`; at most 50 mm",
        ),
        (
            |it| it.camera.window_px = [0, 0, 480],
            "mm from `table.center_m`; at most 50 mm",
        ),
        (
            |it| it.camera.window_px = [200, 0, 480],
            "does not lie in the camera's picture",
        ),
    ];
    for (change, words) in cases {
        let mut settings = settings();
        change(&mut settings);
        let refusal = made.over_table(&settings).expect_err(words);
        assert!(refusal.contains(words), "{words}: {refusal}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn a_point_of_the_square_picture_is_the_one_of_the_cameras_own(
        share in prop::array::uniform2(0.0..1.0_f64),
        image_px in 16_u32..1000,
        turn in 0.0..6.2_f64,
        k1 in -0.1..0.1_f64,
        cut in prop::array::uniform3(0_u32..100),
        sway in prop::array::uniform2(-0.05..0.05_f64),
    ) {
        let mut truth = Truth::usual();
        truth.lens.distortion = [k1, 0.0, 0.001, -0.001, 0.0];
        let world_from_base = Isometry3::rotation(Vector3::new(sway[0], sway[1], 0.0))
            * Isometry3::rotation(Vector3::new(0.0, 0.0, turn))
            * Isometry3::translation(-0.45, 0.0, -0.02);
        let window = [cut[0], cut[1], 480 - cut[1].max(cut[2])];
        let pixel = pixel_at(window, share);
        let square = share.map(|share| share * f64::from(image_px));
        let pair = truth.pair(pixel);
        let wanted = world_from_base.transform_point(&Point3::from(pair.base_m));
        let made = Calibration::make(truth.terms(), truth.grid(4, 0.8), "2026-11-22", None).unwrap();
        let camera = made.camera(&world_from_base, window, image_px);
        prop_assert_eq!(camera.size_px, [image_px; 2]);
        let shown = camera.table_from_pixel(square).unwrap();
        prop_assert!((shown - wanted).norm() < 1e-6, "{} {}", shown, wanted);
        let [u, v] = camera.pixel_from_world(shown).unwrap();
        prop_assert!((u - square[0]).hypot(v - square[1]) < 1e-4);
    }
}
