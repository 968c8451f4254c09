//! Unit tests of `camera::pinhole`.

use super::*;
use fab_program::ImageUp;
use nalgebra::Point3;

#[test]
fn a_camera_survives_as_plain_numbers() {
    for up in [ImageUp::X, ImageUp::Y] {
        let camera = Camera::top_down(0.65, 0.8, 224, up);
        let plain = Pinhole::of(&camera).expect("no distortion");
        let text = serde_json::to_string(&plain).expect("plain numbers");
        let read: Pinhole = serde_json::from_str(&text).expect("a camera");
        let again = read.camera([224, 224]).expect("a pose");
        let point = Point3::new(0.1, -0.05, 0.01);
        let [there, back] =
            [&camera, &again].map(|camera| camera.pixel_from_world(point).expect("in front"));
        assert!(
            (there[0] - back[0]).hypot(there[1] - back[1]) < 1e-9,
            "{there:?} {back:?}"
        );
    }
}

#[test]
fn what_is_no_camera_is_refused() {
    let plain = Pinhole::of(&Camera::top_down(0.65, 0.8, 224, ImageUp::Y)).expect("no distortion");
    let with = |change: &dyn Fn(&mut Pinhole)| {
        let mut plain = plain;
        change(&mut plain);
        plain.camera([224, 224]).expect_err("no camera")
    };
    assert!(with(&|it| it.focal_px[1] = 0.0).contains("above 0"));
    assert!(with(&|it| it.center_px[0] = f64::NAN).contains("not finite"));
    assert!(with(&|it| it.world_from_camera[0][0] = 2.0).contains("rotation"));
    assert!(with(&|it| it.world_from_camera[1][1] = 1.0).contains("rotation"));
}
