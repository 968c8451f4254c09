//! Reads every reply of `tests/fixtures/replies`, and compares the result with the expectation above it.
//!
//! New files are found automatically. Above `---` are, one per line: `action` (of
//! `tests/fixtures/spaces/points.txt`), `action in SPACE`, or `text BEFORE | AFTER`; then `is VALUE` and
//! `repair WORDS`, or `malformed FIELD: MESSAGE`, of which only the first line is compared.

#![allow(clippy::unwrap_used)]

mod common;
#[path = "common/spaces.rs"]
mod spaces;

use fab_program::Proposal;
use fab_program::reply::{self, MAX_REPLY_BYTES, MAX_TEXT_CHARS, Malformed};
use fab_program::space;
use fab_program::{PixelPoint, Program, Value};
use proptest::prelude::*;
use std::fs;
use std::time::{Duration, Instant};

#[test]
fn every_reply_is_read_as_its_fixture_says() {
    let folder = common::workspace().join("tests/fixtures/replies");
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    let mut wrong = Vec::new();
    for file in &files {
        let text = fs::read_to_string(file).unwrap();
        let (head, reply) = text.split_once("---\n").unwrap();
        let (kind, expected) = head.split_once('\n').unwrap();
        let found = match kind.strip_prefix("text ") {
            None => {
                let program = spaces::space(kind.strip_prefix("action in ").unwrap_or("points"));
                described(
                    reply::read_action(&program, reply)
                        .map(|reading| (values(&program, &reading.value), reading.repairs)),
                )
            }
            Some(pattern) => {
                let (before, after) = pattern.split_once('|').unwrap();
                described(
                    reply::read_text(before.trim(), after.trim(), reply)
                        .map(|reading| (reading.value, reading.repairs)),
                )
            }
        };
        if found != expected {
            wrong.push(format!(
                "{}\nexpected\n{expected}found\n{found}",
                file.display()
            ));
        }
    }
    assert!(files.len() > 190, "only {} replies were found", files.len());
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

fn values(program: &Program, proposal: &Proposal) -> String {
    let fields: Vec<String> = program
        .actions
        .iter()
        .map(|field| {
            let value = proposal.get(&field.name).unwrap();
            format!("{} {}", field.name, space::text(field, value))
        })
        .collect();
    fields.join(", ")
}

fn described(outcome: Result<(String, Vec<String>), Malformed>) -> String {
    match outcome {
        Ok((value, repairs)) => {
            let repairs: String = repairs
                .iter()
                .map(|repair| format!("repair {repair}\n"))
                .collect();
            format!("is {value}\n{repairs}")
        }
        Err(Malformed { field, message }) => {
            format!("malformed {field}: {}\n", message.lines().next().unwrap())
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_answer_is_read_or_refused(reply in any::<String>()) {
        let program = spaces::space("points");
        let _ = reply::read_action(&program, &reply);
        let _ = reply::read_text("Instructions:", ".", &reply);
    }

    #[test]
    fn answers_of_likely_pieces_are_read_or_refused(
        pieces in prop::collection::vec(prop::sample::select(vec![
            "pick", "Pick Point", "place", "Place Point", " = ", ": ", "(", ")", "[", "]", "{", "}", "10", "-3.5", ", ",
            "\"", "x", "y", "**", "\n", "not ", "is ", "px", "é", "，", "Instructions:", "Instructions", "- ", "1. ", "\\", "$",
        ]), 0..40)
    ) {
        let program = spaces::space("points");
        let reply = pieces.concat();
        if let Ok(reading) = reply::read_action(&program, &reply) {
            prop_assert_eq!(reading.value.fields.len(), 2);
        }
        if let Ok(reading) = reply::read_text("Instructions:", "", &reply) {
            prop_assert!(!reading.value.is_empty());
        }
    }

    #[test]
    fn answers_of_likely_values_are_read_as_something_that_can_be_written(
        pieces in prop::collection::vec(prop::sample::select(vec![
            "pick = (1, 2)\n", "Tip angle", "tip_angle", "distance", "Grip", " = ", ": ", "\n", " is ", " of ", "45", "0.25", "1/4", "-", "−",
            "pi", "π", "*", "/", " deg", "°", " rad", " mm", " edge", "%", "soft", "softer", "very firm", " or ", " to ", " and ", "not ", "(", ")",
            "[", "]", "{", "}", "\"", ", ", ".", "the ", "about ", "up", "left", "９", "½", "1e9", "\\frac{1}{2}", "|", "é", "~",
        ]), 0..60)
    ) {
        let program = spaces::space("grip");
        let reply = format!("pick = (1, 2) {}", pieces.concat());
        if let Ok(reading) = reply::read_action(&program, &reply) {
            for (field, (name, value)) in program.actions.iter().zip(&reading.value.fields) {
                prop_assert_eq!(&field.name, name);
                match value {
                    Value::Direction { deg } => prop_assert!((0.0..360.0).contains(deg), "{}", deg),
                    Value::Length { length } => prop_assert!(length.is_finite()),
                    Value::Word(_) => prop_assert!(space::declared(field).contains(value)),
                    Value::Point(_) => {}
                }
            }
        }
    }

    #[test]
    fn every_pixel_is_read_back_from_each_form(u in -3000i32..3000, v in -3000i32..3000) {
        let program = spaces::space("points");
        let (pick, place) = (PixelPoint::new(u, v), PixelPoint::new(v, u));
        let asked = reply::answer_format(&program).replacen("(x, y)", &pick.to_string(), 1).replacen("(x, y)", &place.to_string(), 1);
        let reading = reply::read_action(&program, &asked).unwrap();
        prop_assert!(reading.repairs.is_empty(), "{:?}", reading.repairs);
        prop_assert_eq!((reading.value.point("pick"), reading.value.point("place")), (Some(pick), Some(place)));
        let (pick, place) = (Value::Point(pick), Value::Point(place));
        let schema = reply::schema(&program, &[("pick".to_owned(), vec![pick.clone()]), ("place".to_owned(), vec![place.clone()])]);
        let choice = |field: &str| schema["properties"][field]["enum"][0].clone();
        let structured = serde_json::json!({ "pick": choice("pick"), "place": choice("place") });
        for text in [structured.to_string(), serde_json::to_string_pretty(&structured).unwrap()] {
            let reading = reply::read_action(&program, &text).unwrap();
            prop_assert_eq!((reading.value.get("pick"), reading.value.get("place")), (Some(&pick), Some(&place)));
        }
    }
}

#[test]
fn answers_and_texts_that_are_long_are_refused() {
    let program = spaces::space("points");
    let right = "Pick Point = (1, 2)\nPlace Point = (3, 4)\n";
    let padded = |length: usize| format!("{right}{}", " ".repeat(length - right.len()));
    assert!(reply::read_action(&program, &padded(MAX_REPLY_BYTES)).is_ok());
    assert!(reply::read_action(&program, &padded(MAX_REPLY_BYTES + 1)).is_err());
    let text = |length: usize| format!("Instructions: {}", "x".repeat(length));
    assert!(reply::read_text("Instructions:", "", &text(MAX_TEXT_CHARS)).is_ok());
    assert!(reply::read_text("Instructions:", "", &text(MAX_TEXT_CHARS + 1)).is_err());
    assert!(reply::read_text("Instructions:", "", &text(MAX_REPLY_BYTES)).is_err());
}

#[test]
fn answers_of_any_length_take_moments() {
    let program = spaces::space("grip");
    for piece in [
        "grip= ",
        "grip=x ",
        "pick ",
        "pick=(",
        "pick= ",
        "pick - ",
        "tip ",
        "tip angle= ",
        "tip angle=((",
        "tip angle=pi*",
        "distance=1*",
        "distance=1,",
        "distance (",
        "distance=the ",
        "grip=soft or ",
        "soft ",
        "grip: not ",
        "9",
        "-",
        "\"pick\": {",
        "grip=soft, a a a a a a a ",
        "_",
    ] {
        let text = piece.repeat(MAX_REPLY_BYTES / piece.len());
        let begun = Instant::now();
        let _ = reply::read_action(&program, &text);
        let took = begun.elapsed();
        // Linear work takes some hundredths of a second; quadratic work takes minutes.
        assert!(took < Duration::from_secs(4), "{piece:?} took {took:?}");
    }
}

#[test]
fn a_refusal_tells_the_model_the_format() {
    let program = spaces::space("points");
    let refused = reply::read_action(&program, "I do not know.").unwrap_err();
    assert!(
        refused.message.ends_with(&reply::answer_format(&program)),
        "{}",
        refused.message
    );
    assert_eq!(
        reply::answer_format(&program),
        "Pick Point = (x, y)\nPlace Point = (x, y)"
    );
}

#[test]
fn the_schema_offers_each_field_its_own_points() {
    let program = spaces::space("points");
    let schema = reply::schema(
        &program,
        &[("pick".to_owned(), vec![Value::Point(PixelPoint::new(1, 2))])],
    );
    assert_eq!(
        schema["properties"]["pick"]["enum"],
        serde_json::json!(["(1, 2)"])
    );
    assert_eq!(schema["properties"]["place"]["enum"], serde_json::json!([]));
    assert_eq!(schema["required"], serde_json::json!(["pick", "place"]));
    assert_eq!(schema["additionalProperties"], false);
}
