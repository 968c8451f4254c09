//! Unit tests of `draft::measures`.

#![allow(clippy::unwrap_used)]
use super::*;

#[test]
fn what_is_stated_holds_and_the_rest_follows_from_the_pictures() {
    let of = |longer_m| {
        let (camera, cloth) = super::of([140.7, 112.7], 224, longer_m)?;
        Ok::<_, RunError>((camera.height_m, [cloth.dimx, cloth.dimy]))
    };
    assert_eq!(of(None).unwrap(), (0.65, [54, 44]));
    assert_eq!(of(Some(0.5)).unwrap(), (0.971, [81, 65]));
    let message = of(Some(0.02)).unwrap_err().to_string();
    assert!(message.contains("needs a camera 44 mm above"), "{message}");
}
