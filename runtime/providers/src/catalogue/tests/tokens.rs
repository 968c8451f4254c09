//! Tests of token counts: vendors' formulas for pictures, and the rules of thumb for text.

use super::super::tokens::{self, likely_of_text, of_text};
use super::super::*;
use fab_model::{Message, Part, Png, Speaker};
use fab_picture::png;

const GPT_6: ImageTokens = ImageTokens::Patches {
    side_px: 32,
    percent: 120,
};
const CLAUDE: ImageTokens = ImageTokens::Patches {
    side_px: 28,
    percent: 100,
};
const GPT_4O: ImageTokens = ImageTokens::Tiles {
    side_px: 512,
    short_side_px: 768,
    base: 85,
    each: 170,
};

#[test]
fn pictures_have_the_tokens_that_the_vendors_formulas_give() {
    // The first two figures come from the vendor's own page.
    assert_eq!(GPT_6.of(224, 224), Tokens::exactly(59));
    assert_eq!(GPT_6.of(720, 720), Tokens::exactly(635));
    assert_eq!(CLAUDE.of(224, 224), Tokens::exactly(64));
    assert_eq!(CLAUDE.of(720, 720), Tokens::exactly(676));
    let flat = ImageTokens::Flat {
        at_least: 1065,
        at_most: 1101,
    };
    for side in [1, 224, 4096] {
        let tokens = flat.of(side, side);
        assert_eq!((tokens.at_least, tokens.at_most), (1065, 1101));
    }
}

#[test]
fn tiles_are_counted_after_the_short_side_fits() {
    // 720 pixels are two tiles a side, enlarged or not; 224 are one, or two when enlarged.
    assert_eq!(GPT_4O.of(720, 720), Tokens::exactly(85 + 4 * 170));
    let small = GPT_4O.of(224, 224);
    assert_eq!((small.at_least, small.at_most), (85 + 170, 85 + 4 * 170));
    // 1536 by 3072 becomes 768 by 1536: 2 by 3 tiles.
    assert_eq!(GPT_4O.of(1536, 3072), Tokens::exactly(85 + 6 * 170));
}

#[test]
fn no_size_and_no_formula_makes_a_count_overflow() {
    for formula in [GPT_6, CLAUDE, GPT_4O] {
        for (width, height) in [(0, 0), (0, u32::MAX), (1, u32::MAX), (u32::MAX, u32::MAX)] {
            let tokens = formula.of(width, height);
            assert!(
                tokens.at_least <= tokens.at_most,
                "{formula:?} {width} {height}"
            );
        }
    }
}

#[test]
fn likely_tokens_count_words_digits_and_signs() {
    for (text, expected) in [
        ("", 0),
        ("fold", 1),
        ("counter-clockwise", 4),
        ("(123, 45)", 5),
        ("1234567", 3),
        ("  a \n b", 2),
    ] {
        assert_eq!(likely_of_text(text), expected, "{text}");
    }
}

fn of_messages(messages: &[Message], formula: Option<&ImageTokens>) -> Option<Tokens> {
    tokens::of_messages(messages, formula, of_text)
}

#[test]
fn a_picture_without_a_formula_or_a_size_makes_the_sum_unknown() {
    let blank = png::encode(&image::RgbImage::new(224, 224));
    let shown = |bytes: Vec<u8>| {
        let mut message = Message::text(Speaker::User, "fold");
        message.parts.push(Part::Image(Png::new(bytes)));
        [message]
    };
    assert_eq!(
        of_messages(&shown(blank.clone()), Some(&GPT_6)),
        Some(Tokens::exactly(60))
    );
    assert_eq!(of_messages(&shown(blank), None), None);
    assert_eq!(of_messages(&shown(vec![7; 99]), Some(&GPT_6)), None);
    assert_eq!(
        of_messages(&[Message::text(Speaker::User, "fold")], None),
        Some(Tokens::exactly(1))
    );
}
