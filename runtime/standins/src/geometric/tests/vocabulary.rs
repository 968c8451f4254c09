//! Tests that every instruction can be written and is read back unchanged.

use super::super::words::{Compass, Instruction, Sides, Spot};
use proptest::prelude::*;

fn spot() -> impl Strategy<Value = Spot> {
    let at = (0..=8_u8, 0..=8_u8).prop_map(|(along, across)| Spot::At { along, across });
    prop_oneof![1 => Just(Spot::Center), 9 => at]
}

proptest! {
    #[test]
    fn what_is_said_is_understood_as_meant(
        pick in spot(),
        place in spot(),
        steps in prop::sample::select(vec![-1, 0, 1, 2]),
        is_long in any::<bool>(),
        bare in any::<[bool; 4]>(),
    ) {
        // Two places on both middle lines imply no direction; neither does the center.
        let is_vague = |spot: Spot| {
            matches!(spot, Spot::Center | Spot::At { along: 4, across: 4 })
        };
        prop_assume!(!(is_vague(pick) && is_vague(place) && bare == [false; 4]));
        let tells_sides = [pick, place].iter().any(|&spot| spot != Spot::Center);
        let sides = if is_long && tells_sides { Sides::Long } else { Sides::Equal };
        let heading = Compass::nearest(f64::from(steps) * std::f64::consts::FRAC_PI_4);
        let meant = Instruction { pick, place, heading, sides, bare };
        prop_assert_eq!(Instruction::read(&meant.to_string()), Some(meant.clone()), "{}", meant);
    }
}

#[test]
fn directions_that_contradict_each_other_are_not_understood() {
    for sentence in [
        "Pick the left end of the right side and place it on the center",
        "Pick the top left corner and place it on the top corner",
        "Pick the center and place it on the center",
        "Place it on the left end of the top side",
    ] {
        assert_eq!(Instruction::read(sentence), None, "{sentence}");
    }
}

#[test]
fn two_compass_words_side_by_side_are_one_direction() {
    let read = |sentence: &str| Instruction::read(sentence).unwrap();
    let diamond = read("Pick the top corner and place it on the right corner");
    assert_eq!(
        diamond.pick,
        Spot::At {
            along: 8,
            across: 8
        }
    );
    assert_eq!(
        diamond.place,
        Spot::At {
            along: 8,
            across: 0
        }
    );
    assert_eq!(
        diamond.heading,
        Compass::nearest(std::f64::consts::FRAC_PI_4)
    );
    let upright = read("Pick the top-right corner and place it on the lower left corner");
    assert_eq!(
        upright.pick,
        Spot::At {
            along: 8,
            across: 8
        }
    );
    assert_eq!(
        upright.place,
        Spot::At {
            along: 0,
            across: 0
        }
    );
    assert_eq!(upright.heading, Compass::nearest(0.0));
}
