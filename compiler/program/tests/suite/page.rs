//! The tables of `docs/answers.md` are right.

use crate::{read, spaces};
use fab_program::{reply, space};
use std::fs;
use std::path::Path;

/// The space of a table, its field, and how an answer states the others, before and after.
fn around(heading: &str) -> (&str, &str, &str, &str) {
    match heading {
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
    }
}

#[test]
fn every_example_of_the_page_is_read_as_it_says() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/answers.md");
    let page = fs::read_to_string(page).unwrap();
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
            let fields = spaces::space(space);
            let declared = fields.iter().find(|it| it.name == field).unwrap();
            let reading = read(space, &format!("{before}{answer}{after}"));
            reading.map(|reading| space::text(declared, reading.value.get(field).unwrap()))
        };
        let found = found.unwrap_or_else(|_| "refused".to_owned());
        n_rows += 1;
        if found != expected {
            wrong.push(format!("{answer}\n  expected {expected}, found {found}"));
        }
    }
    assert!(n_rows > 20, "only {n_rows} examples were found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
