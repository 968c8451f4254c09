//! Tests of the imperfect stand-in's errors: which, how often, and what determines them.
#![allow(clippy::unwrap_used)]

use super::*;
use fab_model::calls::Unrecorded;
use fab_model::{Message, ModelRole};
use serde_json::json;

/// A planning question of a fold, worded like a real prompt.
fn question(number: usize) -> Request {
    let listed = "(40, 50), (180, 48), (183, 170), (41, 172)";
    let text = format!(
        "- Method of folding: Pick the left end of the top long side and place it on the left end of the bottom long side\n- Question {number}.\n- Cloth corners: {listed}\n- Cloth center: (110, 110)\nPick Point = (x, y)\nPlace Point = (x, y)"
    );
    let values: Vec<&str> = vec!["(40, 50)", "(180, 48)", "(183, 170)", "(41, 172)"];
    let mut places = values.clone();
    places.push("(110, 110)");
    Request {
        schema: Some(json!({ "properties": {
            "pick": { "type": "string", "enum": values },
            "place": { "type": "string", "enum": places },
            "reason": { "type": "string" },
        } })),
        ..Request::new(ModelRole::Text, vec![Message::text(Speaker::User, text)])
    }
}

fn fields(names: &[(&str, &[&str])]) -> Vec<Field> {
    let field = |(name, values): &(&str, &[&str])| Field {
        name: (*name).to_owned(),
        values: values.iter().map(|value| (*value).to_owned()).collect(),
    };
    names.iter().map(field).collect()
}

const CORNERS: &[&str] = &["(10, 10)", "(90, 10)", "(90, 90)"];
const TURNS: &[&str] = &[
    "0 deg", "45 deg", "90 deg", "135 deg", "180 deg", "225 deg", "270 deg", "315 deg",
];
const PULL: &str = "Pick Point = (90, 10)\nDirection = 45 deg\nDistance = 0.25 edge";

/// Spoils the answer [`PULL`] to a prompt that states the last place.
fn spoil(slip: AnswerMistake, said: &str) -> Option<String> {
    let fields = fields(&[
        ("pick", CORNERS),
        ("direction", TURNS),
        ("distance", &["0.1 edge", "0.25 edge"]),
    ]);
    let request = Request {
        messages: vec![Message::text(Speaker::User, said)],
        ..question(0)
    };
    Answer::read(PULL, fields)?.spoilt(slip, &request, &mut Chance::seeded(1))
}

#[test]
fn each_slip_is_what_it_is_called() {
    let near = spoil(
        AnswerMistake::NearLastPlace,
        "The corners are (10, 10), (90, 10), (90, 90).\nThe red rings are where the last pull\nended, (85, 95), and its mirror (15, 5).",
    );
    assert_eq!(
        near.unwrap(),
        r#"{"pick":"(90, 90)","direction":"45 deg","distance":"0.25 edge","reason":"I look at nothing."}"#
    );
    let opposite = spoil(AnswerMistake::Opposite, "");
    assert_eq!(
        opposite.unwrap(),
        r#"{"pick":"(90, 10)","direction":"225 deg","distance":"0.25 edge","reason":"I look at nothing."}"#
    );
    let astray: serde_json::Value =
        serde_json::from_str(&spoil(AnswerMistake::OffTheList, "").unwrap()).unwrap();
    let pick = astray["pick"].as_str().unwrap();
    assert!(
        choices::point(pick).is_some() && !CORNERS.contains(&pick),
        "{pick}"
    );
    assert_eq!(spoil(AnswerMistake::Malformed, ""), None);
}

#[test]
fn without_a_direction_pick_and_place_are_swapped() {
    let fields = fields(&[("pick", CORNERS), ("place", CORNERS)]);
    let answer = Answer::read("Pick Point = (90, 10)\nPlace Point = (10, 10)", fields).unwrap();
    let swapped = answer.spoilt(
        AnswerMistake::Opposite,
        &question(0),
        &mut Chance::seeded(1),
    );
    assert_eq!(
        swapped.unwrap(),
        r#"{"pick":"(10, 10)","place":"(90, 10)","reason":"I look at nothing."}"#
    );
}

#[test]
fn it_errs_as_often_as_declared() {
    let wrong = |rate: f64| {
        let model = Imperfect::new(rate, 5).unwrap();
        let differs = |number: &usize| {
            let request = question(*number);
            model.ask(&request, &mut Unrecorded).unwrap()
                != Geometric.ask(&request, &mut Unrecorded).unwrap()
        };
        (0..400).filter(differs).count()
    };
    assert!(
        Geometric
            .ask(&question(0), &mut Unrecorded)
            .unwrap()
            .text
            .contains("Pick Point = (")
    );
    assert_eq!(wrong(0.0), 0);
    assert_eq!(wrong(1.0), 400);
    // 120 expected; four standard deviations are 37.
    assert!((83..=157).contains(&wrong(0.3)), "{}", wrong(0.3));
}

#[test]
fn a_repetition_and_a_seed_draw_anew_and_equal_questions_do_not() {
    let ask = |seed: u64, repetition: u32| -> Vec<String> {
        let model = Imperfect::new(0.5, seed).unwrap();
        let request = |number| Request {
            repetition,
            ..question(number)
        };
        (0..20)
            .map(|number| model.ask(&request(number), &mut Unrecorded).unwrap().text)
            .collect()
    };
    assert_eq!(ask(1, 0), ask(1, 0));
    assert_ne!(ask(1, 0), ask(1, 1));
    assert_ne!(ask(1, 0), ask(2, 0));
}

#[test]
fn a_question_that_comes_again_in_the_next_step_draws_anew() {
    let model = Imperfect::new(0.5, 1).unwrap();
    let answers = (1..=20).map(|step| {
        let request = Request {
            step,
            ..question(3)
        };
        model.ask(&request, &mut Unrecorded).unwrap().text
    });
    let answers: std::collections::BTreeSet<String> = answers.collect();
    assert!(answers.len() > 1, "{answers:?}");
}

#[test]
fn questions_for_words_are_passed_on() {
    let request = Request {
        schema: None,
        ..question(3)
    };
    let model = Imperfect::new(1.0, 1).unwrap();
    assert_eq!(
        model.ask(&request, &mut Unrecorded).unwrap(),
        Geometric.ask(&request, &mut Unrecorded).unwrap()
    );
}

#[test]
fn a_rate_is_a_probability() {
    assert!(Imperfect::new(-0.1, 0).is_none());
    assert!(Imperfect::new(1.1, 0).is_none());
    assert!(Imperfect::new(f64::NAN, 0).is_none());
}

#[test]
fn a_persistent_error_is_the_same_whoever_asks_and_however_often_and_is_always_an_offered_value() {
    let model = Imperfect::with_errors(1.0, 3, Errors::Persistent).unwrap();
    assert_eq!(model.name(), "imperfect:1:3:persistent");
    let asked = |change: fn(&mut Request)| {
        let mut request = question(7);
        change(&mut request);
        model.ask(&request, &mut Unrecorded).unwrap().text
    };
    let once = asked(|_| {});
    for change in [
        (|it| it.repetition = 4) as fn(&mut Request),
        |it| it.candidate = 2,
        |it| it.step = 2,
        |it| it.start = Some(9),
        |it| it.temperature = Some(0.9),
    ] {
        assert_eq!(asked(change), once);
    }
    let right = Geometric.ask(&question(7), &mut Unrecorded).unwrap().text;
    assert_ne!(once, right);
    let fields = choices::fields(&question(7));
    let answer: serde_json::Value = serde_json::from_str(&once).unwrap();
    for field in fields.iter().filter(|field| !field.values.is_empty()) {
        let value = answer[&field.name].as_str().unwrap().to_owned();
        assert!(field.values.contains(&value), "{once}");
    }
    // Another scene is another draw; of forty, some are right at a rate of a half.
    let half = Imperfect::with_errors(0.5, 3, Errors::Persistent).unwrap();
    let wrong = (0..40).filter(|shift| {
        let mut request = question(7);
        let schema = request.schema.as_ref().unwrap().to_string();
        let moved = schema.replace("(110, 110)", &format!("(110, {})", 90 + shift));
        request.schema = Some(serde_json::from_str(&moved).unwrap());
        let reply = half.ask(&request, &mut Unrecorded).unwrap();
        reply != Geometric.ask(&request, &mut Unrecorded).unwrap()
    });
    // 20 expected; four standard deviations are 13.
    assert!((7..=33).contains(&wrong.count()));
}

#[test]
fn a_neighbouring_error_moves_one_point_to_the_nearest_other_one() {
    let model = Imperfect::with_errors(1.0, 1, Errors::Neighbour).unwrap();
    assert_eq!(model.name(), "imperfect:1:1:neighbour");
    // The right answer carries (40, 50) to (41, 172).
    let right = Geometric.ask(&question(0), &mut Unrecorded).unwrap().text;
    assert!(
        right.contains("(40, 50)") && right.contains("(41, 172)"),
        "{right}"
    );
    let wrong = (0..40).map(|number| {
        let text = model.ask(&question(number), &mut Unrecorded).unwrap().text;
        let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
        ["pick", "place"].map(|name| answer[name].as_str().unwrap().to_owned())
    });
    let wrong: std::collections::BTreeSet<[String; 2]> = wrong.collect();
    let pair = |pick: &str, place: &str| [pick.to_owned(), place.to_owned()];
    // (40, 50) is 122 from (41, 172); (41, 172) is 93 from the center.
    let expected = [
        pair("(41, 172)", "(41, 172)"),
        pair("(40, 50)", "(110, 110)"),
    ];
    assert_eq!(wrong, expected.into());
}
