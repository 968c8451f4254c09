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
    let mut terms = terms();
    terms.window = Window::from([200, 0, 480]);
    let refusal = make(terms, Truth::usual().grid(4, 0.8));
    assert!(matches!(
        refusal.unwrap_err().faults[..],
        [Fault::Window { .. }]
    ));
}

/// What a person would state in the settings.
fn settings() -> Settings {
    let Terms {
        center_m,
        height_m,
        up_deg,
        ..
    } = terms();
    let text = format!(
        "
name = 'lab'
model = 'j2n6s200'
driver = 'simulated'
calibration = 'lab.toml'
table = {{ center_m = {center_m:?} }}
workspace = {{ min_m = [0.15, -0.525, 0.012], max_m = [0.75, 0.525, 0.5], rest_m = [0.3, -0.4, 0.25] }}
fingers = {{ count = 2, open = 0.0, closed = 6400.0, tolerance = 200.0 }}
[camera]
source = 'directory'
folder = 'shots'
window_px = [80, 0, 480]
height_m = {:?}
up_deg = {:?}
[camera.intrinsics]
size_px = [640, 480]
focal_px = [600.0, 602.0]
middle_px = [322.0, 238.0]
distortion = [0.0, 0.0, 0.0, 0.0, 0.0]
",
        height_m.unwrap(),
        up_deg.unwrap()
    );
    Settings::parse(&text).unwrap()
}

type Edit = fn(&mut Settings);

#[test]
fn settings_that_disagree_with_the_calibration_are_refused() {
    let expected = Terms {
        camera: "shots".to_owned(),
        ..terms()
    };
    assert_eq!(Terms::of(&settings(), [640, 480], 3.0), expected);
    let made = make(expected, measured_grid(11, 4, 0.8)).unwrap();
    made.check_settings(&settings()).unwrap();
    let cases: [(Edit, &str); 9] = [
        (
            |it| it.table.center_m[2] += 0.1,
            "99.8 mm from its height there; at most 5 mm",
        ),
        (
            |it| it.table.center_m[0] -= 0.15,
            "150 mm from `table.center_m`; at most 50 mm",
        ),
        (
            |it| it.camera.window_px = [0, 0, 480],
            "mm from `table.center_m`; at most 50 mm",
        ),
        (
            |it| it.camera.window_px = [200, 0, 480],
            "does not lie in the camera's picture",
        ),
        (
            |it| it.camera.height_m = Some(1.3),
            "% from `camera.height_m`, which is 1.3",
        ),
        (
            |it| it.camera.height_m = None,
            "`camera.height_m` is not stated",
        ),
        (
            |it| it.camera.up_deg = Some(90.0),
            "degrees from `camera.up_deg`, which is 90",
        ),
        (
            |it| it.camera.intrinsics.as_mut().unwrap().size_px = [1280, 960],
            "its intrinsics are for [1280, 960] px, and were for [640, 480]",
        ),
        (
            |it| it.camera.intrinsics.as_mut().unwrap().focal_px = [780.0, 780.0],
            "its focal length is [780.0, 780.0], and was [600.0, 602.0]",
        ),
    ];
    for (change, words) in cases {
        let mut settings = settings();
        change(&mut settings);
        let refusal = made.check_settings(&settings).expect_err(words);
        assert!(refusal.to_string().contains(words), "{words}: {refusal}");
    }
}

#[test]
fn a_wider_window_than_was_measured_is_refused() {
    let truth = Truth::usual();
    let part = Window::from([200, 120, 240]);
    let places = [0.1, 0.4, 0.6, 0.9];
    let places = places.into_iter().flat_map(|v| places.map(|u| [u, v]));
    let pairs = places.map(|share| truth.pair(part.pixel_at(share)));
    let narrow = Terms {
        window: part,
        ..terms()
    };
    let made = make(narrow, pairs.collect()).unwrap();
    let refusal = made.check_settings(&settings()).unwrap_err().to_string();
    assert!(
        refusal.contains("in the plane at a corner of the table; at most 2 mm"),
        "{refusal}"
    );
    let mut fitting = settings();
    fitting.camera.window_px = [200, 120, 240];
    made.check_settings(&fitting).unwrap();
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
        let made = make(truth.terms(), truth.grid(4, 0.8)).unwrap();
        let camera = made.camera(&world_from_base, &window, image_px);
        prop_assert_eq!(camera.size_px, [image_px; 2]);
        let shown = camera.table_from_pixel(square).unwrap();
        prop_assert!((shown - wanted).norm() < 1e-6, "{} {}", shown, wanted);
        let [u, v] = camera.pixel_from_world(shown).unwrap();
        prop_assert!((u - square[0]).hypot(v - square[1]) < 1e-4);
    }
}
