//! A text as lines with their origins.

use super::*;
use fab_program::render::{Place, Stretch};

fn origin(line: u32, value: Option<&str>) -> Origin {
    Origin {
        source: "role".to_owned(),
        value: value.map(str::to_owned),
        place: Some(Place {
            file: "a.fab".to_owned(),
            line,
        }),
    }
}

/// A text of consecutive stretches.
fn said(pieces: &[(&str, u32, Option<&str>)]) -> PromptText {
    let mut said = PromptText::default();
    for (text, line, value) in pieces {
        let start = said.text.len();
        said.text.push_str(text);
        said.stretches.push(Stretch {
            bytes: start..said.text.len(),
            origin: origin(*line, *value),
        });
    }
    said
}

fn shown(said: &PromptText) -> Vec<(String, Option<u32>)> {
    let line = |line: Line| {
        let place = line.origin.and_then(|origin| origin.place);
        (line.text, place.map(|place| place.line))
    };
    of_text(said).map(line).collect()
}

#[test]
fn a_line_knows_its_file() {
    let said = said(&[
        ("Corners: ", 3, None),
        ("(1, 2), (3, 4)", 3, Some("corners")),
        (".\n", 3, None),
        ("\n", 4, None),
        ("Go.", 5, None),
    ]);
    let expected = [
        ("Corners: (1, 2), (3, 4).".to_owned(), Some(3)),
        (String::new(), Some(4)),
        ("Go.".to_owned(), Some(5)),
    ];
    assert_eq!(shown(&said), expected);
}

#[test]
fn a_value_of_several_lines_belongs_to_the_line_that_shows_it() {
    let said = said(&[
        ("Answer:\n", 7, None),
        ("Pick = (x, y)\nPlace = (x, y)", 8, Some("format")),
        ("\n", 8, None),
        ("End", 9, None),
    ]);
    let expected = [
        ("Answer:".to_owned(), Some(7)),
        ("Pick = (x, y)".to_owned(), Some(8)),
        ("Place = (x, y)".to_owned(), Some(8)),
        ("End".to_owned(), Some(9)),
    ];
    assert_eq!(shown(&said), expected);
}

#[test]
fn what_stands_between_two_texts_is_nobodys() {
    let mut both = said(&[("One", 1, None)]);
    both.push("\n\n", said(&[("Two", 5, None)]));
    let expected = [
        ("One".to_owned(), Some(1)),
        (String::new(), None),
        ("Two".to_owned(), Some(5)),
    ];
    assert_eq!(shown(&both), expected);
}
