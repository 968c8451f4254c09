//! Unit tests of `demos::words`.

use super::*;

#[test]
fn directions_are_those_of_the_picture() {
    let center = PixelPoint::new(100, 100);
    let cases = [
        ((150, 100), "right"),
        ((140, 60), "top right"),
        ((100, 50), "top"),
        ((60, 60), "top left"),
        ((50, 101), "left"),
        ((50, 99), "left"),
        ((60, 140), "bottom left"),
        ((101, 180), "bottom"),
        ((150, 150), "bottom right"),
    ];
    for ((u, v), expected) in cases {
        assert_eq!(
            direction(PixelPoint::new(u, v), center),
            expected,
            "({u}, {v})"
        );
    }
}

#[test]
fn a_fold_is_said_by_what_it_moves() {
    let corner = ClothPoint::Particle {
        right: 0.0,
        front: 0.0,
    };
    let pick = NamedPoint {
        point: &corner,
        at: PixelPoint::new(40, 50),
    };
    let place = NamedPoint {
        point: &ClothPoint::Center,
        at: PixelPoint::new(112, 112),
    };
    let center = PixelPoint::new(112, 112);
    assert_eq!(
        instruction(pick, place, center),
        "Pick the corner at the top left and place it on the center of the cloth"
    );
    assert_eq!(
        reason(pick, place, center),
        "Of the listed points (40, 50) is the corner at the top left, and (112, 112) is the center of the cloth."
    );
}
