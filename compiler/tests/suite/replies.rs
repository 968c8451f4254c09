//! Reads every reply of `tests/fixtures/replies`, and compares the result with the expectation above it.
//!
//! New files are found automatically. Above `---` are, one per line: `action` (of
//! `tests/fixtures/spaces/points.txt`), `action in SPACE`, or `text BEFORE | AFTER`; then what must be read:
//!
//! - `is VALUE` and `repair WORDS`, or `malformed FIELD: MESSAGE`, of which only the first line is compared.
//! - `means VALUE`, `refused FIELD` or `refused or means VALUE`: what a careful person would say, judged before the
//!   reader was run. Messages and repairs are not compared.
//! - `should mean VALUE`: the same, but it is refused today. At most 2.5 % of the right answers may be.
//! - `should be refused`: the same, but it is read today. At most 2 % of the others may be; many were written to slip through.
//!
//! `FABC_REPLIES=FOLDER` tries the files of another folder.

use crate::common;
use crate::growth;
use crate::spaces;
use fab_program::Proposal;
use fab_program::reply::{self, MAX_REPLY_BYTES, MAX_TEXT_CHARS, Malformed};
use fab_program::space;
use fab_program::{PixelPoint, Program, Value};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

/// The format that a refusal in the space `points` ends with.
const FORMAT_OF_POINTS: &str = "Pick Point = (x, y)\nPlace Point = (x, y)";

#[test]
fn every_reply_is_read_as_its_fixture_says() {
    let other = std::env::var_os("FABC_REPLIES").map(PathBuf::from);
    let is_other = other.is_some();
    let folder = other.unwrap_or_else(|| common::workspace().join("tests/fixtures/replies"));
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    let mut wrong = Vec::new();
    let (mut n_right, mut n_refused, mut n_misread) = (0, 0, 0);
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
        n_right += usize::from(expected.contains("mean"));
        n_refused +=
            usize::from(expected.starts_with("should mean") && found.starts_with("malformed"));
        n_misread +=
            usize::from(expected.starts_with("should be refused") && found.starts_with("is "));
        if !is_as_expected(&found, expected) {
            wrong.push(format!(
                "{}\nexpected\n{expected}found\n{found}",
                file.display()
            ));
        }
    }
    assert!(
        is_other || files.len() > 1500,
        "only {} replies were found",
        files.len()
    );
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    assert!(
        n_refused * 40 <= n_right,
        "{n_refused} of {n_right} right answers are refused"
    );
    let n_others = files.len() - n_right;
    assert!(
        n_misread * 50 <= n_others,
        "{n_misread} of {n_others} answers are read that are no right ones"
    );
}

/// Begins of the names of fixtures that are about numbers or words, so that two may differ in those alone.
const ABOUT_VALUES: [&str; 5] = ["direction_", "distance_", "names_", "values_", "words_"];

#[test]
fn no_two_replies_differ_only_in_their_numbers() {
    let mut seen: BTreeMap<[String; 3], String> = BTreeMap::new();
    let mut alike = Vec::new();
    let numbers = |text: &str| {
        let mut plain = String::new();
        for piece in text.split_inclusive(|it: char| !it.is_ascii_digit() && it != '.') {
            let last = piece.chars().next_back().filter(|it| !it.is_ascii_digit());
            plain.extend(
                piece
                    .starts_with(|it: char| it.is_ascii_digit())
                    .then_some('0'),
            );
            plain.extend(last);
        }
        plain
    };
    let folder = common::workspace().join("tests/fixtures/replies");
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if ABOUT_VALUES.iter().any(|begin| name.starts_with(begin)) {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let (head, reply) = text.split_once("---\n").unwrap();
        let (kind, expected) = head.split_once('\n').unwrap();
        let mut words = expected.split_whitespace();
        // The other words of a refusal are a message.
        let verdict = match words.next() {
            Some("malformed" | "refused") => words.next().unwrap_or_default().to_owned(),
            _ => numbers(expected).replacen("means ", "is ", 1),
        };
        if let Some(other) = seen.insert([kind.to_owned(), verdict, numbers(reply)], name.clone()) {
            alike.push(format!("{other} and {name}"));
        }
    }
    assert!(seen.len() > 1500);
    assert!(alike.is_empty(), "\n{}", alike.join("\n"));
}

#[test]
fn every_example_of_the_page_is_read_as_it_says() {
    let page = fs::read_to_string(common::workspace().join("docs/answers.md")).unwrap();
    let around = |heading: &str| match heading {
        "Points" => ("points", "pick", "", "\nPlace Point = (30, 40)"),
        "Directions" => (
            "paper",
            "direction",
            "Pick Point = (10, 20)\n",
            "\nDistance = 0.5 edge",
        ),
        "Lengths" => (
            "paper",
            "distance",
            "Pick Point = (10, 20)\nDirection = 45 deg\n",
            "",
        ),
        "Words" => (
            "grip",
            "grip",
            "Pick Point = (10, 20)\nTip angle = 60 deg\nDistance = 10 mm\n",
            "",
        ),
        other => panic!("no action space for `{other}`"),
    };
    let mut heading = "";
    let mut wrong = Vec::new();
    let mut n_rows = 0;
    for line in page.lines() {
        heading = line.strip_prefix("## ").unwrap_or(heading);
        let Some(row) = line.strip_prefix("| `") else {
            continue;
        };
        let (answer, expected) = row.split_once("` | ").unwrap();
        let expected = expected.trim_end_matches(" |").trim_matches('`');
        let answer = answer.replace(" ↵ ", "\n");
        let found = if heading == "Texts" {
            reply::read_text("Instructions:", "", &answer).map(|reading| reading.value)
        } else {
            let (space, field, before, after) = around(heading);
            let program = spaces::space(space);
            let declared = program.actions.iter().find(|it| it.name == field).unwrap();
            let reading = reply::read_action(&program, &format!("{before}{answer}{after}"));
            reading.map(|reading| space::text(declared, reading.value.get(field).unwrap()))
        };
        let found = found.unwrap_or_else(|_| "refused".to_owned());
        n_rows += 1;
        if found != expected {
            wrong.push(format!("{answer}\n  expected {expected}, found {found}"));
        }
    }
    assert!(n_rows > 60, "only {n_rows} examples were found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Returns whether a reading is the expected one.
fn is_as_expected(found: &str, expected: &str) -> bool {
    let value = found
        .lines()
        .next()
        .and_then(|line| line.strip_prefix("is "));
    let field = found
        .strip_prefix("malformed ")
        .and_then(|rest| rest.split_once(':'))
        .map(|(field, _)| field);
    let line = expected.trim_end();
    // What is as it should be is no longer known to be wrong.
    if line == "should be refused" {
        value.is_some()
    } else if line.starts_with("should mean ") {
        value.is_none()
    } else if let Some(meant) = line.strip_prefix("means ") {
        value == Some(meant)
    } else if let Some(meant) = line.strip_prefix("refused or means ") {
        value.is_none_or(|value| value == meant)
    } else if let Some(wanted) = line.strip_prefix("refused") {
        field.is_some_and(|field| wanted.is_empty() || wanted.trim() == field)
    } else {
        found == expected
    }
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
        Err(Malformed { field, message, .. }) => {
            format!("malformed {field}: {}\n", message.lines().next().unwrap())
        }
    }
}

/// The fields of the space `paper`, as the format writes them.
const NAMES: [&str; 3] = ["Pick Point", "Direction", "Distance"];

/// Values of each field.
const VALUES: [&[&str]; 3] = [
    &["(10, 20)", "(100, 7)", "(31, 200)"],
    &[
        "0 deg", "45 deg", "90 deg", "135 deg", "180 deg", "225 deg", "270 deg", "315 deg",
    ],
    &["0.1 edge", "0.25 edge", "0.5 edge", "0.75 edge", "1 edge"],
];

/// Ways to state a field, on a line of its own.
const FORMS: [fn(&str, &str) -> String; 9] = [
    |name, value| format!("{name} = {value}"),
    |name, value| format!("- **{name}:** {value}"),
    |name, value| format!("The {} is {value}.", name.to_lowercase()),
    |name, value| format!("{name} -> `{value}`"),
    |name, value| format!("{{\"{}\": \"{value}\"}}", name.to_lowercase()),
    |name, value| format!("| {name} | {value} |"),
    |name, value| format!("{value} is the {}.", name.to_lowercase()),
    |name, value| format!("<{0}>{value}</{0}>", name.to_lowercase().replace(' ', "_")),
    |name, value| format!("{name}:\n{value}"),
];

/// What a first stage may say.
const TEXTS: [&str; 4] = [
    "Fold the back left corner onto the front left corner.",
    "Fold the back left corner onto the front right corner.",
    "Carry the right edge to the left.",
    "Bring every corner to the center.",
];

/// Ways to state a text, on a line of its own.
const TEXT_FORMS: [fn(&str) -> String; 6] = [
    |text| format!("Instructions: {text}"),
    |text| format!("**Instructions:** {text}"),
    |text| format!("- instructions: {text}"),
    |text| format!("## Instructions:\n{text}"),
    |text| format!("Instructions: \"{text}\""),
    |text| format!("{{\"instructions\": \"{text}\"}}"),
];

/// What may stand between two statements.
const BETWEEN: [&str; 5] = [
    "\n",
    "\n\n",
    "\nIt lies flat.\n",
    "\n\nThis is the fold:\n\n",
    "\n---\n",
];

/// What may stand around a right answer.
const WRAPS: [fn(&str) -> String; 9] = [
    |answer| format!("<think>Perhaps Pick Point = (1, 2) and 90 deg.</think>\n{answer}"),
    |answer| format!("```\n{answer}```\n"),
    |answer| format!("The cloth is flat, and its corner at (5, 6) is free.\n\n{answer}"),
    |answer| format!("{answer}\nThis brings the corner to the other side.\n"),
    |answer| format!("> Pick Point = (9, 9)\n\n{answer}"),
    |answer| format!("<answer>\n{answer}</answer>\n"),
    |answer| format!("# Answer\n\n{answer}"),
    |answer| format!("{answer}\n{answer}"),
    |answer| format!("~~Direction = 7 deg~~\n{answer}"),
];

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
    fn two_different_values_of_a_field_are_never_accepted(
        field in 0..3_usize, first in 0..8_usize, other in 1..8_usize,
        forms in (0..FORMS.len(), 0..FORMS.len()), between in prop::sample::select(BETWEEN.to_vec()),
    ) {
        let program = spaces::space("paper");
        let n_values = VALUES[field].len();
        let (first, other) = (first % n_values, (first % n_values + 1 + other % (n_values - 1)) % n_values);
        let statement = |form: usize, value: usize| FORMS[form](NAMES[field], VALUES[field][value]);
        let rest: Vec<String> = (0..3).filter(|it| *it != field).map(|it| FORMS[0](NAMES[it], VALUES[it][1])).collect();
        let answer = format!("{}{between}{}\n{}", statement(forms.0, first), statement(forms.1, other), rest.join("\n"));
        match reply::read_action(&program, &answer) {
            Err(refused) => for value in [first, other] {
                // The offered values are listed in the sentence after that.
                let why = refused.message.split(" Choose one").next().unwrap();
                prop_assert!(why.contains(VALUES[field][value]), "{}\n{}", answer, refused.message);
            },
            Ok(reading) => prop_assert!(false, "{}\n{:?}", answer, reading),
        }
    }

    #[test]
    fn two_different_texts_are_never_accepted(
        first in 0..TEXTS.len(), other in 1..TEXTS.len(), forms in (0..TEXT_FORMS.len(), 0..TEXT_FORMS.len()), between in prop::sample::select(BETWEEN.to_vec()),
    ) {
        let [first, other] = [first, (first + other) % TEXTS.len()].map(|it| TEXTS[it]);
        let answer = format!("{}{between}{}\n", TEXT_FORMS[forms.0](first), TEXT_FORMS[forms.1](other));
        match reply::read_text("Instructions:", "", &answer) {
            Err(refused) => for text in [first, other] {
                prop_assert!(refused.message.contains(text), "{}\n{}", answer, refused.message);
            },
            Ok(reading) => prop_assert!(false, "{}\n{:?}", answer, reading),
        }
        let twice = format!("{}{between}{}\n", TEXT_FORMS[forms.0](first), TEXT_FORMS[forms.1](first));
        let reading = reply::read_text("Instructions:", "", &twice).map_err(|refused| TestCaseError::fail(format!("{twice}\n{}", refused.message)))?;
        prop_assert_eq!(reading.value, first, "{}", twice);
    }

    #[test]
    fn what_wraps_a_right_answer_changes_nothing(
        values in (0..3_usize, 0..8_usize, 0..5_usize), forms in (0..FORMS.len(), 0..FORMS.len(), 0..FORMS.len()),
        wraps in prop::collection::vec(0..WRAPS.len(), 0..4),
    ) {
        let program = spaces::space("paper");
        let values = [VALUES[0][values.0], VALUES[1][values.1], VALUES[2][values.2]];
        let forms = [forms.0, forms.1, forms.2];
        let mut answer: String = (0..3).map(|it| format!("{}\n", FORMS[forms[it]](NAMES[it], values[it]))).collect();
        for wrap in wraps {
            answer = WRAPS[wrap](&answer);
        }
        let read = reply::read_action(&program, &answer).map_err(|refused| TestCaseError::fail(format!("{answer}\n{}", refused.message)))?;
        for (field, value) in program.actions.iter().zip(values) {
            prop_assert_eq!(space::text(field, read.value.get(&field.name).unwrap()), value, "{}", answer);
        }
    }

    #[test]
    fn every_pixel_is_read_back_from_each_form(u in -3000i32..3000, v in -3000i32..3000) {
        let program = spaces::space("points");
        let (pick, place) = (PixelPoint::new(u, v), PixelPoint::new(v, u));
        let asked = FORMAT_OF_POINTS.replacen("(x, y)", &pick.to_string(), 1).replacen("(x, y)", &place.to_string(), 1);
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

/// Reads answers that repeat one of every so many pieces, of a length and of eight times that.
fn take_linear_time(length: usize, every: usize) {
    let program = spaces::space("grip");
    let pieces = [
        "grip= ",
        "grip=x ",
        "pick ",
        "grip grip ",
        "pick=(",
        "a * ",
        "1. 45 deg\n",
        "tip angle=60 deg\nwait ",
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
        "{\"pick\": ",
        "[",
        "<think>",
        "</think>",
        "~~",
        "| pick ",
        "| pick |\n",
        "- ",
        "Instructions: ",
        "Instructions: x\n",
        "For example:\n",
        "move it 1 edge ",
        "{\"reason\": \"the shortest\tpull. ",
        "the shortest pull. ",
        "the arrow starts at (1, 2). ",
        "pull it 60 deg ",
        "<point ",
        "if it ",
        "</",
        "the pick, ",
        "(picking ",
        "pick / x ",
        "with pick would ",
        "grip=soft, a would otherwise ",
        "pull it up ",
        "grip=soft,",
        "{\"to\":1,",
        "I take 45 deg ",
        "take the lower left corner ",
        "a ",
        "the ",
        "so ",
        "of ",
        "not ",
        "this is the pick ",
        "(1, 2) ",
        "point ",
        "very ",
    ];
    let compass = spaces::space("paper");
    for piece in pieces.iter().rev().step_by(every) {
        growth::assert_linear(piece, length, |length| {
            let text = piece.repeat(length / piece.len());
            let _ = reply::read_action(&program, &text);
            let _ = reply::read_action(&compass, &text);
            let _ = reply::read_text("Instructions:", "", &text);
        });
    }
}

#[test]
fn reading_takes_linear_time() {
    take_linear_time(1 << 13, 3);
}

#[test]
#[ignore = "long"]
fn reading_the_longest_answers_takes_linear_time() {
    take_linear_time(MAX_REPLY_BYTES / 8, 8);
}

#[test]
fn a_refusal_tells_the_model_the_format() {
    let program = spaces::space("points");
    let refused = reply::read_action(&program, "I do not know.").unwrap_err();
    assert!(
        refused.message.ends_with(FORMAT_OF_POINTS),
        "{}",
        refused.message
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

#[test]
fn an_answer_with_one_unreadable_field_says_where_the_others_stand() {
    let program = spaces::space("points");
    let read = |reply: &str| reply::read_action(&program, reply).unwrap_err();
    let refused = read("**Pick**: [41.3, 56]\nPlace Point = huh");
    assert_eq!(refused.field, "place");
    let [pick] = &refused.stated[..] else {
        panic!("{:?}", refused.stated)
    };
    assert_eq!(
        (pick.field.as_str(), pick.text.as_str(), pick.at),
        ("pick", "**Pick**: [41.3, 56]", 0)
    );
    let boxed = reply::read_action(
        &program,
        "Pick Point = \\boxed{(41, 167)}\nPlace Point = (3, 4)",
    )
    .unwrap();
    assert_eq!(boxed.stated[0].text, "Pick Point = \\boxed{(41, 167)}");
}
