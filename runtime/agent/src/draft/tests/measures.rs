//! Unit tests of `draft::measures`.

#![allow(clippy::unwrap_used)]
use super::*;

#[test]
fn what_is_stated_holds_and_the_rest_follows_from_the_pictures() {
    let close = |a: f64, b: f64| (a - b).abs() < 1e-6;
    let of = |height_m, longer_m| {
        let stated = StatedMeasures { height_m, longer_m };
        super::of([140.7, 112.7], 224, &stated).map(|(camera, cloth)| {
            let fov_deg = camera.fov_rad.to_degrees();
            (camera.height_m, fov_deg, [cloth.dimx, cloth.dimy])
        })
    };
    let (height_m, fov_deg, dims) = of(None, None).unwrap();
    assert!(close(height_m, 0.65) && close(fov_deg, 45.0));
    assert_eq!(dims, [54, 44]);
    let (height_m, fov_deg, dims) = of(Some(1.3), None).unwrap();
    assert!(close(height_m, 1.3) && close(fov_deg, 45.0));
    assert_eq!(dims, [108, 87]);
    let (height_m, fov_deg, dims) = of(None, Some(0.5)).unwrap();
    assert!(close(height_m, 0.971) && close(fov_deg, 45.0), "{height_m}");
    assert_eq!(dims, [81, 65]);
    let (height_m, fov_deg, dims) = of(Some(1.0), Some(0.5)).unwrap();
    assert!(close(height_m, 1.0) && close(fov_deg, 43.8), "{fov_deg}");
    assert_eq!(dims, [81, 65]);
    for (height_m, longer_m, told) in [
        (None, Some(0.02), "needs a camera"),
        (Some(0.1), Some(1.2), "with a field of view of 169 degrees"),
        (Some(4.9), Some(0.05), "with a field of view of 1 degrees"),
        (Some(4.9), None, "a cloth of 2534 mm"),
    ] {
        let message = of(height_m, longer_m).unwrap_err().to_string();
        assert!(message.contains(told), "{message}");
    }
}
