//! Tests that every instruction can be written and is read back unchanged.

use super::super::instruction::{Instruction, Spot};
use proptest::prelude::*;

fn spot() -> impl Strategy<Value = Spot> {
    prop::option::weighted(0.9, prop::array::uniform2(0..=8_u8))
}

proptest! {
    #[test]
    fn what_is_said_is_understood_as_meant(
        pick in spot(),
        place in spot(),
        heading in 0..4_usize,
        is_long in any::<bool>(),
        bare in any::<[bool; 4]>(),
    ) {
        let meant = Instruction { pick, place, heading, is_long, bare };
        let line = format!("- Method of folding: {meant}.");
        prop_assert_eq!(Instruction::read(&line), Some(meant.clone()), "{}", meant);
    }
}

#[test]
fn other_words_are_not_understood() {
    for line in [
        "pick 0-8, place center, in eighths",
        "pick 0-9, place center, in eighths along the sides to the right and across them",
        "pick 0-8, in eighths along the sides to the right and across them",
        "Pick the corner at the top left and place it on the center of the cloth",
        "place 0-8, in eighths along the sides to the right and across them",
    ] {
        assert_eq!(Instruction::read(line), None, "{line}");
    }
}
