//! Tests of the kinds of errors, their rate, and what their draws depend on.
#![allow(clippy::unwrap_used)]

use super::*;
use fab_model::calls::{Budget, Ledger};
use fab_model::{Message, ModelRole, Speaker};

const PULL: &str = "\
One edge is 200 px in the picture.
Corners: (100, 100), (300, 100), (100, 300), (320, 310)
The center is (200, 200).
The last pull ended at (110, 290).
Pick Point = (x, y)
Direction = 0 deg | 45 deg | 90 deg | 135 deg | 180 deg | 225 deg | 270 deg | 315 deg
Distance = 0.1 edge | 0.5 edge";

fn request(words: &str, start: u64, step: u32) -> Request {
    let messages = vec![Message::text(Speaker::User, words)];
    Request {
        start: Some(start),
        step,
        ..Request::new(ModelRole::Vision, messages)
    }
}

fn asked(model: &Imperfect, request: &Request) -> String {
    model
        .ask(request, &mut Ledger::unwritten(&Budget::default()))
        .unwrap()
        .text
}

/// The lines of an answer without its reason.
fn action(text: &str) -> Vec<&str> {
    text.lines().filter(|line| line.contains(" = ")).collect()
}

const RIGHT: [&str; 3] = [
    "Pick Point = (320, 310)",
    "Direction = 315 deg",
    "Distance = 0.1 edge",
];

#[test]
fn errors_come_at_their_rate_and_in_four_kinds() {
    let model = Imperfect::new(0.3, 1, Errors::Mixed).unwrap();
    let answers = (0..400).map(|start| asked(&model, &request(PULL, start, 1)));
    let answers: Vec<String> = answers.collect();
    let count = |wanted: [&str; 3]| answers.iter().filter(|it| action(it) == wanted).count();
    let unreadable = answers.iter().filter(|it| action(it).is_empty()).count();
    let near_last = count(["Pick Point = (100, 300)", RIGHT[1], RIGHT[2]]);
    let opposite = count([RIGHT[0], "Direction = 135 deg", RIGHT[2]]);
    let off = 400 - count(RIGHT) - near_last - opposite - unreadable;
    for (kind, n_wrong) in [
        ("near the last place", near_last),
        ("opposite", opposite),
        ("off the list", off),
        ("unreadable", unreadable),
    ] {
        assert!((15..=45).contains(&n_wrong), "{kind}: {n_wrong}");
    }
}

#[test]
fn a_reworded_prompt_meets_the_same_errors() {
    let model = Imperfect::new(0.5, 3, Errors::Mixed).unwrap();
    let reworded = format!("Be careful with the cloth.\n{PULL}");
    let mut wrong = 0;
    for start in 0..40 {
        let [plain, other] =
            [PULL, &reworded].map(|words| asked(&model, &request(words, start, 2)));
        assert_eq!(plain, other, "start {start}");
        wrong += usize::from(action(&plain) != RIGHT);
    }
    assert!((10..=30).contains(&wrong), "{wrong}");
}

#[test]
fn examples_change_no_draw_and_corrections_do() {
    let model = Imperfect::new(0.5, 3, Errors::Mixed).unwrap();
    let with = |before: &[(&str, &str)], after: &[(&str, &str)], start| {
        let turns = |pairs: &[(&str, &str)], first, second| -> Vec<Message> {
            let pairs = pairs.iter();
            pairs
                .flat_map(|(a, b)| [Message::text(first, *a), Message::text(second, *b)])
                .collect()
        };
        let mut question = request(PULL, start, 2);
        let own = question.messages.clone();
        question.messages = turns(before, Speaker::User, Speaker::Assistant);
        question.messages.extend(own);
        question
            .messages
            .extend(turns(after, Speaker::Assistant, Speaker::User));
        asked(&model, &question)
    };
    let example = [(
        PULL,
        "Pick Point = (320, 310)\nDirection = 315 deg\nDistance = 0.1 edge",
    )];
    let correction = [(
        "I would pull it a little to the side.",
        "Your answer cannot be read.",
    )];
    let mut changed = 0;
    for start in 0..40 {
        let plain = with(&[], &[], start);
        assert_eq!(with(&example, &[], start), plain, "start {start}");
        changed += usize::from(with(&[], &correction, start) != plain);
    }
    assert!(changed > 10, "{changed}");
}

#[test]
fn candidates_starts_and_steps_have_draws_of_their_own_and_persistent_errors_none() {
    let answers = |errors, change: fn(&mut Request, u64)| {
        let model = Imperfect::new(0.5, 5, errors).unwrap();
        let answers = (0..30).map(|number| {
            let mut question = request(PULL, 7, 1);
            change(&mut question, number);
            asked(&model, &question)
        });
        answers.collect::<std::collections::BTreeSet<_>>().len()
    };
    let candidate: fn(&mut Request, u64) = |request, number| request.candidate = number as u32;
    let start: fn(&mut Request, u64) = |request, number| request.start = Some(number);
    let step: fn(&mut Request, u64) = |request, number| request.step = number as u32;
    for change in [candidate, start, step] {
        assert!(answers(Errors::Mixed, change) > 3);
    }
    assert_eq!(answers(Errors::Persistent, candidate), 1);
    assert_eq!(answers(Errors::Persistent, start), 3);
}

#[test]
fn a_neighbour_is_the_offered_point_nearest_to_the_right_one() {
    let model = Imperfect::new(1.0, 1, Errors::Neighbour).unwrap();
    let text = asked(&model, &request(PULL, 1, 1));
    let beside = ["Pick Point = (300, 100)", RIGHT[1], RIGHT[2]];
    assert_eq!(action(&text), beside);
}

#[test]
fn a_rate_outside_of_0_to_1_is_none() {
    for rate in [-0.1, 1.1, f64::NAN] {
        assert!(Imperfect::new(rate, 1, Errors::Mixed).is_none(), "{rate}");
    }
}
