//! Unit tests of `lowering`.

use super::*;

#[test]
fn sides_fit_or_become_the_nearest_multiple_and_a_resized_picture_stays() {
    let sides = [224, 720, 5, 41, 42, 100_000];
    let number = |number| NonZeroU32::new(number).expect("not 0");
    for (multiples_of_px, expected) in [
        (None, sides),
        (Some(number(28)), [224, 728, 28, 28, 56, MAX_SENT_PX]),
        (Some(number(9000)), [MAX_SENT_PX; 6]),
    ] {
        let lowering = Lowering {
            multiples_of_px,
            ..Lowering::PIXELS
        };
        assert_eq!(sides.map(|side| lowering.sent([side; 2])[0]), expected);
        assert_eq!(expected.map(|side| lowering.sent([side; 2])[0]), expected);
    }
}
