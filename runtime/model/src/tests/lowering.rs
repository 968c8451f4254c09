//! Unit tests of `lowering`.

use super::*;

#[test]
fn sides_fit_or_become_the_nearest_multiple_and_a_resized_picture_stays() {
    let sides = [224, 720, 5, 41, 42, 100_000];
    let number = |number| NonZeroU32::new(number).expect("not 0");
    for (resize, expected) in [
        (Resize::Never, sides),
        (
            Resize::Multiples { of_px: number(28) },
            [224, 728, 28, 28, 56, MAX_SENT_PX],
        ),
        (
            Resize::Multiples {
                of_px: number(9000),
            },
            [MAX_SENT_PX; 6],
        ),
    ] {
        let lowering = Lowering {
            resize,
            ..Lowering::PIXELS
        };
        assert_eq!(sides.map(|side| lowering.sent([side; 2])[0]), expected);
        assert_eq!(expected.map(|side| lowering.sent([side; 2])[0]), expected);
    }
}
