//! Where a colour lies in a picture.

use fab_program::{Colour, Face};

#[test]
fn a_colour_is_found_by_its_hue_and_a_grey_by_its_brightness() {
    let ranges = |rgb| {
        let name = "a colour".to_owned();
        Colour { name, rgb }.in_picture()
    };
    assert_eq!(ranges([255, 0, 0]), [[330.0, 30.0], [0.5, 1.0], [0.6, 1.0]]);
    assert_eq!(
        ranges([0, 0, 128]),
        [[210.0, 270.0], [0.5, 1.0], [0.3, 1.0]]
    );
    assert_eq!(
        ranges([200, 200, 204]),
        [[0.0, 360.0], [0.0, 0.3], [0.48, 0.96]]
    );
    let [upper, under] = [Face::Upper, Face::Under].map(|face| Colour::recorded(face).in_picture());
    assert_eq!(upper, [[357.0, 57.0], [0.5, 1.0], [0.6, 1.0]]);
    assert_eq!(under, [[280.0, 340.0], [0.2, 1.0], [0.3, 1.0]]);
}
