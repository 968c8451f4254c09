//! Any answer is read or refused, whatever it consists of.

use crate::{read, spaces};
use fab_program::{Value, reply, space};
use proptest::prelude::*;

/// Pieces of statements, objects and texts.
const PIECES: [&str; 52] = [
    "pick",
    "Pick Point",
    "place",
    "Place Point",
    " = ",
    ": ",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "10",
    "-3.5",
    ", ",
    "\"",
    "x",
    "y",
    "**",
    "\n",
    "not ",
    "is ",
    "px",
    "é",
    "，",
    "Instructions:",
    "Instructions",
    "- ",
    "1. ",
    "\\",
    "$",
    "<think>",
    "</think>",
    "<pick>",
    "</pick>",
    "<point x=\"1\"",
    "<|im_end|>",
    "｜",
    "◁",
    "▷",
    "analysis",
    "~~",
    "> ",
    "```",
    "|",
    "|-|",
    "\\boxed{",
    "\\begin{",
    "<!--",
    "\"point_2d\": ",
    "\"label\": ",
    "\u{feff}",
];

/// Pieces of values.
const VALUES: [&str; 50] = [
    "pick = (1, 2)\n",
    "Tip angle",
    "tip_angle",
    "distance",
    "Grip",
    " = ",
    ": ",
    "\n",
    " is ",
    " of ",
    "45",
    "0.25",
    "1/4",
    "-",
    "−",
    "pi",
    "π",
    "*",
    "/",
    " deg",
    "°",
    " rad",
    " mm",
    " edge",
    "%",
    "soft",
    "softer",
    "very firm",
    " or ",
    " to ",
    " and ",
    "not ",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "\"",
    ", ",
    ".",
    "the ",
    "about ",
    "up",
    "left",
    "９",
    "½",
    "1e9",
    "\\frac{1}{2}",
    "|",
];

fn pieces(of: &'static [&'static str], most: usize) -> impl Strategy<Value = String> {
    prop::collection::vec(prop::sample::select(of), 0..most).prop_map(|pieces| pieces.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_answer_is_read_or_refused(answer in any::<String>()) {
        let _ = read("points", &answer);
        let _ = reply::read_text("Instructions:", ".", &answer);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let answer = String::from_utf8_lossy(&bytes);
        let _ = read("grip", &answer);
        let _ = reply::read_text("<instruction>", "</instruction>", &answer);
    }

    #[test]
    fn answers_of_likely_pieces_are_read_or_refused(answer in pieces(&PIECES, 40)) {
        if let Ok(reading) = read("points", &answer) {
            prop_assert_eq!(reading.value.fields.len(), 2);
            for stated in reading.stated {
                prop_assert!(answer[stated.at..].starts_with(&stated.text), "{:?}", stated);
            }
        }
        if let Ok(reading) = reply::read_text("Instructions:", "", &answer) {
            prop_assert!(!reading.value.is_empty());
        }
    }

    #[test]
    fn only_values_that_are_offered_are_read(values in pieces(&VALUES, 60)) {
        let answer = format!("pick = (1, 2) {values}");
        if let Ok(reading) = read("grip", &answer) {
            for (field, (name, value)) in spaces::space("grip").iter().zip(&reading.value.fields) {
                prop_assert_eq!(&field.name, name);
                let is_point = matches!(value, Value::Point(_));
                prop_assert!(is_point || space::declared(field).contains(value), "{}", answer);
            }
        }
    }
}
