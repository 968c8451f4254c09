//! Tests of choosing among listed points: answer format, refusals, membership.

use super::*;
use proptest::prelude::*;

const CORNERS: [PixelPoint; 5] = [
    PixelPoint::new(40, 60),
    PixelPoint::new(180, 60),
    PixelPoint::new(180, 170),
    PixelPoint::new(40, 170),
    PixelPoint::new(110, 60),
];
const CENTER: PixelPoint = PixelPoint::new(110, 115);
const WORDS: &str =
    "pick 0-8, place 0-0, in eighths along the long sides to the right and across them";

fn turn(speaker: Speaker, text: &str) -> Message {
    Message::text(speaker, text)
}

#[test]
fn the_answer_begins_with_the_two_lines_of_the_format() {
    let prompt = planning_prompt(WORDS, &CORNERS, CENTER);
    let reply = ask(ModelRole::Text, vec![turn(Speaker::User, &prompt)]);
    let lines: Vec<&str> = reply.lines().collect();
    assert_eq!(
        lines[..2],
        ["Pick Point = (40, 60)", "Place Point = (40, 170)"]
    );
    assert!(lines[2].contains("turned by about 0 degrees"), "{reply}");
}

/// Both left corners of a square are folded in, and one of the five remaining corners was not detected. Then a pixel's
/// difference decides whether an upright or a slanted rectangle is the tightest.
#[test]
fn a_corner_that_was_not_detected_does_not_slant_the_rectangle() {
    let words = "pick 8-8, place center, in eighths along the sides to the right and across them; bare 0-0 0-8";
    for shift in 0..81 {
        let [a, b, c, d] =
            [shift % 3, shift / 3 % 3, shift / 9 % 3, shift / 27].map(|shift| shift - 1);
        let right_top = PixelPoint::new(176, 46 + a);
        let listed = [
            PixelPoint::new(176 + b, 177),
            right_top,
            PixelPoint::new(109 + c, 177),
            PixelPoint::new(46, 114 + d),
        ];
        assert_eq!(
            planned(words, &listed, CENTER),
            [right_top, CENTER],
            "{listed:?}"
        );
    }
}

#[test]
fn refused_answers_are_not_repeated() {
    let mut talk = vec![turn(
        Speaker::User,
        &planning_prompt(WORDS, &CORNERS, CENTER),
    )];
    let mut given = Vec::new();
    for _ in 0..6 {
        let reply = ask(ModelRole::Text, talk.clone());
        let points = points_of(&reply);
        assert!(!given.contains(&points), "{points:?} again");
        given.push(points);
        talk.push(turn(Speaker::Assistant, &reply));
        talk.push(turn(Speaker::User, "That will not do. Answer anew."));
    }
    assert_eq!(given[0], [CORNERS[0], CORNERS[3]]);
}

#[test]
fn when_everything_was_refused_it_says_so() {
    let corners = &CORNERS[..3];
    let words = "pick 0-8, place 8-8, in eighths along the sides to the right and across them";
    let mut talk = vec![turn(
        Speaker::User,
        &planning_prompt(words, corners, CENTER),
    )];
    for round in 0..20 {
        let reply = ask(ModelRole::Text, talk.clone());
        if reply.contains("was refused") {
            // Three picks with two other corners and the center each.
            assert_eq!(round, 9, "{reply}");
            return;
        }
        talk.push(turn(Speaker::Assistant, &reply));
        talk.push(turn(Speaker::User, "No."));
    }
    panic!("it never ran out of nine pairs");
}

#[test]
fn examples_in_earlier_turns_are_not_the_question() {
    let example = planning_prompt(
        "pick 8-8, place center, in eighths along the sides to the right and across them",
        &CORNERS[..4],
        CENTER,
    );
    let talk = vec![
        turn(Speaker::User, &example),
        turn(
            Speaker::Assistant,
            "Pick Point = (40, 60)\nPlace Point = (40, 170)",
        ),
        turn(Speaker::User, &planning_prompt(WORDS, &CORNERS, CENTER)),
    ];
    assert_eq!(
        points_of(&ask(ModelRole::Text, talk)),
        [CORNERS[0], CORNERS[3]]
    );
}

#[test]
fn pictures_of_earlier_examples_are_not_the_question() {
    let [first, second] = VIEW.pictures(&rectangle_fold());
    let [other_first, other_second] = VIEW.pictures(&square_fold());
    let talk = vec![
        user(vec![png(&other_first), png(&other_second)]),
        turn(Speaker::Assistant, "Instructions: something."),
        user(vec![png(&first), png(&second)]),
        turn(Speaker::Assistant, "I cannot."),
        turn(Speaker::User, "Answer in the format."),
    ];
    let reply = ask(ModelRole::Vision, talk);
    assert!(reply.contains(&instruction(&[first, second])), "{reply}");
}

proptest! {
    #[test]
    fn pick_and_place_are_always_listed_and_differ(
        points in prop::collection::btree_set((0..224_i32, 0..224_i32), 4..20),
        center in (0..224_i32, 0..224_i32),
        words in prop::sample::select(vec![
            WORDS,
            "pick 4-8, place center, in eighths along the sides to the right and across them",
            "pick 8-0, place 1-8, in eighths along the sides to the lower-right and across them",
        ]),
    ) {
        let corners: Vec<PixelPoint> = points.iter().map(|&(u, v)| PixelPoint::new(u, v)).collect();
        let center = PixelPoint::new(center.0, center.1);
        let reply = ask(ModelRole::Text, vec![turn(Speaker::User, &planning_prompt(words, &corners, center))]);
        prop_assume!(!reply.contains("enclose no area"));
        let [pick, place] = points_of(&reply);
        prop_assert!(corners.contains(&pick));
        prop_assert!(corners.contains(&place) || place == center);
        prop_assert_ne!(pick, place);
    }
}

#[test]
fn how_to_carry_is_answered_with_the_value_nearest_to_the_usual() {
    let asked = "Pick Point = (x, y)\nPlace Point = (x, y)\nLift = 0 mm | 40 mm | 100 mm\n\
                 Speed = 0.1 m/s | 0.4 m/s\n- Release height = 0 mm";
    assert_eq!(
        prompt::manner_lines(asked),
        ["Lift = 40 mm", "Speed = 0.4 m/s", "Release height = 0 mm"]
    );
    assert!(prompt::manner_lines("Pick Point = (x, y)").is_empty());
}

#[test]
fn it_says_where_its_pick_lies_if_the_format_offers_quadrants() {
    let asked = "Pick Point = (x, y)\nPlace Point = (x, y)\nCorner = upper_left | lower_right";
    let [pick, center] = [[180, 170], [111, 111]].map(fab_program::PixelPoint::from);
    let said = |asked, pick, about| prompt::quadrant_line(asked, pick, about);
    assert_eq!(said(asked, pick, center).unwrap(), "Corner = lower_right");
    assert_eq!(said(asked, center, pick).unwrap(), "Corner = upper_left");
    assert_eq!(said("Grip = soft | upper_left", pick, center), None);
}
