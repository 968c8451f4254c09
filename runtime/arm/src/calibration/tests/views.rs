//! Tests that the camera of the tasks' picture agrees with the calibration at every point.

use super::*;
use crate::calibration::view::Window;
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
        assert_eq!(Window::from(window).is_in([640, 480]), is_in, "{window:?}");
    }
    let mut terms = terms(Method::Plane);
    terms.window = Window::from([200, 0, 480]);
    let refusal = Calibration::make(terms, Truth::usual().grid(4, 0.8), "2026-11-22", None);
    assert!(matches!(
        refusal.unwrap_err().faults[..],
        [Fault::Window { .. }]
    ));
}

const ROBOT: &str = "
name = 'lab'
model = 'j2n6s200'
driver = 'simulated'
calibration = 'lab.toml'
table = { center_m = [0.45, 0.0, 0.02] }
workspace = { min_m = [0.15, -0.525, 0.01], max_m = [0.75, 0.525, 0.5], rest_m = [0.3, -0.4, 0.25] }
fingers = { count = 2, open = 0.0, closed = 6400.0, tolerance = 200.0 }
camera = { source = 'simulated', window_px = [80, 0, 480] }
";

#[test]
fn settings_that_ask_for_more_than_was_measured_are_refused() {
    let settings = Settings::parse(ROBOT).unwrap();
    let terms = Terms::of(&settings, Method::Plane, [640, 480], 3.0);
    assert_eq!(terms, self::terms(Method::Plane));
    let truth = Truth::usual();
    let part = Window::from([200, 120, 240]);
    let narrow = Terms {
        window: part,
        ..terms
    };
    let places = [0.1, 0.4, 0.6, 0.9];
    let places = places.into_iter().flat_map(|v| places.map(|u| [u, v]));
    let pairs = places
        .map(|share| truth.pair(part.pixel_at(share)))
        .collect();
    let made = Calibration::make(narrow, pairs, "2026-11-22", None).unwrap();
    let refusal = made.check_settings(&settings).unwrap_err();
    assert!(
        matches!(refusal.faults[..], [Fault::Spread { .. }]),
        "{refusal}"
    );
    let mut fitting = settings.clone();
    fitting.camera.window_px = [200, 120, 240];
    assert_eq!(made.check_settings(&fitting), Ok(()));
    fitting.workspace.min_m[0] = 5.0;
    fitting.workspace.max_m[0] = 6.0;
    let refusal = made.check_settings(&fitting).unwrap_err();
    assert!(
        matches!(refusal.faults[..], [Fault::OutOfReach { .. }]),
        "{refusal}"
    );
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
        let window = Window::from([cut[0], cut[1], 480 - cut[1].max(cut[2])]);
        let pixel = window.pixel_at(share);
        let square = share.map(|share| share * f64::from(image_px));
        let pair = truth.pair(pixel);
        let wanted = world_from_base.transform_point(&Point3::from(pair.base_m));
        for method in [Method::Plane, Method::Rigid] {
            let mut terms = terms(method);
            terms.intrinsics = Some(truth.intrinsics());
            let made = Calibration::make(terms, truth.grid(4, 0.8), "2026-11-22", None).unwrap();
            let camera = made.camera(&world_from_base, &window, image_px);
            prop_assert_eq!(camera.size_px, [image_px; 2]);
            let shown = camera.world_from_pixel(square, pair.depth_m.unwrap()).unwrap();
            prop_assert!((shown - wanted).norm() < 1e-6, "{:?} {} {}", method, shown, wanted);
            let [u, v] = camera.pixel_from_world(shown).unwrap();
            prop_assert!((u - square[0]).hypot(v - square[1]) < 1e-4);
            if method == Method::Plane {
                prop_assert!((camera.table_from_pixel(square).unwrap() - wanted).norm() < 1e-6);
            }
        }
    }
}
