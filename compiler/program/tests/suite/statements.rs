//! A value is read from every form of statement, wherever it stands; two different ones are refused.

use crate::{read, spaces};
use fab_program::reply::{self, Aside, MAX_REPLY_BYTES, MAX_TEXT_CHARS};
use fab_program::{PixelPoint, Value, space};
use proptest::prelude::*;

/// The format that a refusal in the space `points` ends with.
const FORMAT_OF_POINTS: &str = "Pick Point = (x, y)\nPlace Point = (x, y)";

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
const FORMS: [fn(&str, &str) -> String; 10] = [
    |name, value| format!("{name} = {value}"),
    |name, value| format!("- **{name}:** {value}"),
    |name, value| format!("1. {name} = {value}, as before"),
    |name, value| format!("{name} -> `{value}`"),
    |name, value| format!("{{\"{}\": \"{value}\"}}", name.to_lowercase()),
    |name, value| format!("| {name} | {value} |"),
    |name, value| format!("<{0}>{value}</{0}>", name.to_lowercase().replace(' ', "_")),
    |name, value| {
        let name = name.to_lowercase().replace(' ', "_");
        format!("<function=act><parameter={name}>{value}</parameter></function>")
    },
    |name, value| format!("{name}:\n{value}"),
    |name, value| format!("$$\\boxed{{\\text{{{name}}} = {value}}}$$"),
];

/// What a first stage may say.
const TEXTS: [&str; 4] = [
    "Fold the back left corner onto the front left corner.",
    "Fold the back left corner onto the front right corner.",
    "Carry the right edge to the left.",
    "Bring every corner to the center.",
];

/// Ways to state a text, on a line of its own.
const TEXT_FORMS: [fn(&str) -> String; 7] = [
    |text| format!("Instructions: {text}"),
    |text| format!("**Instructions:** {text}"),
    |text| format!("- instructions: {text}"),
    |text| format!("## Instructions:\n{text}"),
    |text| format!("Instructions: \"{text}\""),
    |text| format!("{{\"instructions\": \"{text}\"}}"),
    |text| format!("<instructions>{text}</instructions>"),
];

/// What may stand between two statements.
const BETWEEN: [&str; 6] = [
    "\n",
    "\n\n",
    "\nIt lies flat.\n",
    "\n\nNo wait, this is the fold:\n\n",
    "\n---\n",
    "<|im_end|>\n",
];

/// What may stand around a right answer.
const WRAPS: [fn(&str) -> String; 13] = [
    |answer| format!("<think>Perhaps Pick Point = (1, 2) and 90 deg.</think>\n{answer}"),
    |answer| format!("<|START_THINKING|>Pick Point = (1, 2)<|END_THINKING|>\n{answer}"),
    |answer| format!("```\n{answer}```\n"),
    |answer| format!("The cloth is flat, and its corner at (5, 6) is free.\n\n{answer}"),
    |answer| format!("{answer}\nThis brings the corner to the other side.\n"),
    |answer| format!("{answer}\nThe lower right corner at (7, 8) is picked, by 90 deg.\n"),
    |answer| format!("> Pick Point = (9, 9)\n\n{answer}"),
    |answer| format!("<answer>\n{answer}</answer>\n"),
    |answer| format!("# Answer\n\n{answer}"),
    |answer| format!("{answer}\n{answer}"),
    |answer| format!("~~Direction = 7 deg~~\n{answer}"),
    |answer| format!("<|im_start|>assistant\n{answer}<|im_end|>\n"),
    |answer| format!("{answer}<end_of_turn>\n[EOS]\n"),
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn two_different_values_of_a_field_are_never_accepted(
        field in 0..3_usize, first in 0..8_usize, other in 1..8_usize,
        forms in (0..FORMS.len(), 0..FORMS.len()), between in prop::sample::select(BETWEEN.to_vec()),
    ) {
        let n_values = VALUES[field].len();
        let (first, other) = (first % n_values, (first % n_values + 1 + other % (n_values - 1)) % n_values);
        let statement = |form: usize, value: usize| FORMS[form](NAMES[field], VALUES[field][value]);
        let rest: Vec<String> = (0..3).filter(|it| *it != field).map(|it| FORMS[0](NAMES[it], VALUES[it][1])).collect();
        let answer = format!("{}{between}{}\n{}", statement(forms.0, first), statement(forms.1, other), rest.join("\n"));
        match read("paper", &answer) {
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
        let values = [VALUES[0][values.0], VALUES[1][values.1], VALUES[2][values.2]];
        let forms = [forms.0, forms.1, forms.2];
        let mut answer: String = (0..3).map(|it| format!("{}\n", FORMS[forms[it]](NAMES[it], values[it]))).collect();
        for wrap in wraps {
            answer = WRAPS[wrap](&answer);
        }
        let read = read("paper", &answer).map_err(|refused| TestCaseError::fail(format!("{answer}\n{}", refused.message)))?;
        for (field, value) in spaces::space("paper").iter().zip(values) {
            prop_assert_eq!(space::text(field, read.value.get(&field.name).unwrap()), value, "{}", answer);
        }
    }

    #[test]
    fn every_pixel_is_read_back_from_each_form(u in -3000i32..3000, v in -3000i32..3000) {
        let (pick, place) = (PixelPoint::new(u, v), PixelPoint::new(v, u));
        let asked = FORMAT_OF_POINTS.replacen("(x, y)", &pick.to_string(), 1).replacen("(x, y)", &place.to_string(), 1);
        let reading = read("points", &asked).unwrap();
        prop_assert!(reading.repairs.is_empty(), "{:?}", reading.repairs);
        prop_assert_eq!((reading.value.point("pick"), reading.value.point("place")), (Some(pick), Some(place)));
        let structured = serde_json::json!({ "pick": pick.to_string(), "place": place.to_string() });
        let lists = serde_json::json!({ "pick": [u, v], "place": { "x": v, "y": u } });
        let labels = serde_json::json!([{ "point_2d": [u, v], "label": "pick" }, { "point_2d": [v, u], "label": "place" }]);
        let pretty = serde_json::to_string_pretty(&structured).unwrap();
        for (text, is_exact) in [(structured.to_string(), true), (pretty, true), (lists.to_string(), false), (labels.to_string(), false)] {
            let reading = read("points", &text).unwrap();
            prop_assert_eq!(reading.repairs.is_empty(), is_exact, "{}", text);
            prop_assert_eq!((reading.value.point("pick"), reading.value.point("place")), (Some(pick), Some(place)));
        }
    }
}

#[test]
fn every_offered_value_is_read_back_without_repair() {
    for space in ["region", "paper", "grip", "manner"] {
        let fields = spaces::space(space);
        let point = Value::Point(PixelPoint::new(41, 167));
        let offered = |field: &fab_program::ActionField| match space::declared(field) {
            values if values.is_empty() => vec![point.clone()],
            values => values,
        };
        let most = fields.iter().map(|field| offered(field).len()).max();
        for index in 0..most.unwrap() {
            let chosen = fields.iter().map(|field| {
                let offered = offered(field);
                (field, offered[index % offered.len()].clone())
            });
            let chosen: Vec<_> = chosen.collect();
            let lines = chosen
                .iter()
                .map(|(field, value)| space::statement(field, &space::text(field, value)));
            let object: serde_json::Map<_, _> = chosen
                .iter()
                .map(|(field, value)| (field.name.clone(), space::text(field, value).into()))
                .collect();
            let lines = lines.collect::<Vec<_>>().join("\n");
            for answer in [lines, serde_json::Value::Object(object).to_string()] {
                let reading = read(space, &answer).unwrap();
                assert!(reading.repairs.is_empty(), "{answer}");
                for (field, value) in &chosen {
                    assert_eq!(reading.value.get(&field.name), Some(value), "{answer}");
                }
            }
        }
    }
}

#[test]
fn answers_and_texts_that_are_long_are_refused() {
    let right = "Pick Point = (1, 2)\nPlace Point = (3, 4)\n";
    let padded = |length: usize| format!("{right}{}", " ".repeat(length - right.len()));
    assert!(read("points", &padded(MAX_REPLY_BYTES)).is_ok());
    assert!(read("points", &padded(MAX_REPLY_BYTES + 1)).is_err());
    let text = |length: usize| format!("Instructions: {}", "x".repeat(length));
    let read_text = |length| reply::read_text("Instructions:", "", &text(length));
    assert!(read_text(MAX_TEXT_CHARS).is_ok());
    assert!(read_text(MAX_TEXT_CHARS + 1).is_err());
    assert!(read_text(MAX_REPLY_BYTES).is_err());
}

#[test]
fn a_refusal_tells_the_model_the_format() {
    let refused = read("points", "I do not know.").unwrap_err();
    assert!(
        refused.message.ends_with(FORMAT_OF_POINTS),
        "{}",
        refused.message
    );
    let refused = reply::read_text("Instructions:", " Explanation:", "?").unwrap_err();
    assert!(
        refused.message.ends_with("\nInstructions: … Explanation:"),
        "{}",
        refused.message
    );
}

#[test]
fn an_answer_with_one_unreadable_field_says_where_the_others_stand() {
    let refused = read("points", "**Pick**: [41.3, 56]\nPlace Point = huh").unwrap_err();
    assert_eq!(refused.field, "place");
    let [pick] = &refused.stated[..] else {
        panic!("{:?}", refused.stated)
    };
    assert_eq!(
        (pick.field.as_str(), pick.text.as_str(), pick.at),
        ("pick", "**Pick**: [41.3, 56]", 0)
    );
    assert_eq!(pick.repairs, ["pick: rounded (41.3, 56) to (41, 56)"]);
}

#[test]
fn what_states_a_value_is_quoted_whole() {
    for (statement, at) in [
        ("Pick Point = (10, 20)", 0),
        ("**Pick Point**: `(10, 20)`", 2),
        ("\"pick\": [10, 20]", 1),
    ] {
        let before = " ".repeat(at);
        let answer = match statement.starts_with('"') {
            true => format!("{{{statement}, \"place\": [3, 4]}}"),
            false => format!("{before}{statement}\nPlace Point = (3, 4)"),
        };
        let reading = read("points", &answer).unwrap();
        let stated = &reading.stated[0];
        assert_eq!((stated.text.as_str(), stated.at), (statement, at));
    }
}

#[test]
fn what_is_set_aside_is_told_with_its_place() {
    let answer = "<think>hm</think>\n> old\n~~older~~ <!-- x -->\nPick Point = (1, 2)\nPlace Point = (3, 4)<|im_end|>";
    let reading = read("points", answer).unwrap();
    let asides = reading.asides.into_iter();
    let asides: Vec<_> = asides.map(|(span, why)| (&answer[span], why)).collect();
    assert_eq!(
        asides,
        [
            ("<think>hm</think>", Aside::Thought),
            ("> old", Aside::Quotation),
            ("~~older~~", Aside::StruckOut),
            ("<|im_end|>", Aside::Token),
        ]
    );
}
