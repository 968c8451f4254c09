//! Tests that incomprehensible prompts are answered in words, without an instruction or points.

use super::*;
use proptest::prelude::*;

/// The reply must not be readable as an instruction, and must say `why`.
fn assert_says(pictures: &[RgbImage], why: &str) {
    let reply = described(pictures);
    assert!(reply.contains(why), "{reply}");
    assert!(!reply.contains("Instructions"), "{reply}");
}

#[test]
fn an_erased_arrow_is_named() {
    let fold = rectangle_fold();
    assert_says(
        &[VIEW.paint(&fold.before), VIEW.paint(&fold.after)],
        "I see no arrow on the first picture.",
    );
}

#[test]
fn two_arrows_are_named_whether_they_cross_or_not() {
    let [mut first, second] = VIEW.pictures(&rectangle_fold());
    let mut apart = first.clone();
    draw_arrow(&mut apart, VIEW.pixel([0.5, 0.4]), VIEW.pixel([0.5, -0.4]));
    assert_says(&[apart, second.clone()], "more than one arrow");
    draw_arrow(&mut first, VIEW.pixel([0.4, 0.3]), VIEW.pixel([-0.8, 0.1]));
    assert_says(&[first, second], "more than one arrow");
}

#[test]
fn a_line_without_a_ring_is_no_arrow() {
    let fold = rectangle_fold();
    let mut first = VIEW.paint(&fold.before);
    for row in 60..160 {
        first.put_pixel(42, row, Rgb([0; 3]));
        first.put_pixel(43, row, Rgb([0; 3]));
    }
    assert_says(&[first, VIEW.paint(&fold.after)], "I see no arrow");
}

#[test]
fn an_arrow_that_starts_beside_the_cloth_is_named() {
    let fold = Fold {
        tail: [-0.7, 0.6],
        ..rectangle_fold()
    };
    assert_says(&VIEW.pictures(&fold), "does not start on the cloth");
}

#[test]
fn pictures_that_show_nothing_are_named() {
    let [first, _] = VIEW.pictures(&rectangle_fold());
    let bare = View {
        cloth: LIGHT_TILES[0],
        tiles: [LIGHT_TILES[0]; 2],
        ..VIEW
    };
    let [bare, _] = bare.pictures(&rectangle_fold());
    assert_says(&[bare], "I see no cloth on the picture");
    let parts = vec![
        png(&first),
        Part::Image(Png::new(b"not a picture".to_vec())),
    ];
    let reply = ask(ModelRole::Vision, vec![user(parts)]);
    assert_eq!(
        reply,
        "I cannot describe this step: a picture cannot be read."
    );
}

#[test]
fn prompts_that_lack_something_are_answered_without_points() {
    let square = "(10, 10), (90, 10), (90, 90), (10, 90)";
    let words = "- Instruction: pick 0-8, place center, in eighths along the sides to the right and across them";
    for (prompt, why) in [
        ("Hello.".to_owned(), "no line names a point"),
        (String::new(), "no line names a point"),
        (
            format!("- Instruction: fold it\n- Corners: {square}"),
            "no line names a point",
        ),
        (words.to_owned(), "no corners are listed"),
        (
            format!("{words}\n- Corners: {square}"),
            "no center is given",
        ),
        (
            format!("{words}\n- Corners: (1, 1), (2, 2), (3, 3)\n- Center: (1, 1)"),
            "enclose no area",
        ),
        (
            format!("{words}\n- Corners: (3, 3)\n- Center: (2, 2)"),
            "enclose no area",
        ),
    ] {
        let reply = ask(ModelRole::Text, vec![Message::text(Speaker::User, prompt)]);
        assert!(
            reply.starts_with("I cannot choose points") && reply.contains(why),
            "{reply}"
        );
        assert!(!reply.contains('('), "{reply}");
    }
    assert!(ask(ModelRole::Text, Vec::new()).contains("no line names a point"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn no_text_makes_it_panic(text in "[\\PC\n]{0,200}", tail in "(pick|place|0-8|9-1|center|to|right|long|corner|bare|;|\\(1, 2\\)|\n| ){0,60}") {
        ask(ModelRole::Text, vec![Message::text(Speaker::User, format!("{text}{tail}"))]);
    }

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let picture = Part::Image(Png::new(bytes));
        let reply = ask(ModelRole::Vision, vec![user(vec![picture.clone(), picture])]);
        prop_assert!(!reply.contains("Instructions"));
    }

    #[test]
    #[ignore = "long"]
    fn no_noise_makes_it_panic(seed in prop::collection::vec(any::<u8>(), 400), side_px in 1..80_u32) {
        let level = |at: u32| seed[at as usize % seed.len()];
        let noise = RgbImage::from_fn(side_px, side_px, |column, row| {
            Rgb([if level(column * 7 + row * 31) < 90 { 0 } else { 255 }; 3])
        });
        described(&[noise.clone(), noise]);
    }
}
