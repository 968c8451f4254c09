//! The tables and lists of the language reference are complete; the book's own test compiles its examples.

#![allow(clippy::unwrap_used)]

mod common;

use fab_compiler::diag::CODES;
use std::fs;

fn reference() -> String {
    fs::read_to_string(common::workspace().join("docs/language.md")).unwrap()
}

#[test]
fn the_table_of_codes_is_complete() {
    let text = reference();
    let (_, table) = text.split_once("## Codes\n").unwrap();
    let expected: Vec<String> = CODES
        .iter()
        .map(|entry| {
            format!(
                "| {} | {} | {} |",
                entry.code.as_str(),
                entry.severity.as_str(),
                entry.title
            )
        })
        .collect();
    let rows: Vec<&str> = table
        .lines()
        .filter(|line| line.starts_with("| F"))
        .collect();
    assert_eq!(rows, expected, "write:\n{}", expected.join("\n"));
}

#[test]
fn the_list_of_words_that_name_nothing_is_complete() {
    let text = reference();
    let (_, listed) = text.split_once("```text\n").unwrap();
    let (listed, _) = listed.split_once("```").unwrap();
    let listed: Vec<&str> = listed.split_whitespace().collect();
    let words = text
        .split(|character: char| !character.is_ascii_alphanumeric() && character != '_')
        .filter(|word| !word.is_empty());
    for word in words.filter(|word| word.starts_with(|first: char| first.is_ascii_alphabetic())) {
        assert_eq!(
            fab_grammar::is_keyword(word),
            listed.contains(&word),
            "{word}"
        );
    }
}

#[test]
fn limits_are_as_stated() {
    let text = reference();
    for row in [
        format!("| a file | {} KiB |", fab_grammar::MAX_BYTES >> 10),
        format!(
            "| files in one compilation | {}, each {} `use`s deep |",
            fab_compiler::MAX_FILES,
            fab_compiler::MAX_USE_DEPTH
        ),
        format!(
            "| text in one compilation | {} KiB |",
            fab_compiler::MAX_TOTAL_BYTES >> 10
        ),
        format!(
            "| letters of a word outside of texts | {} |",
            fab_grammar::MAX_WORD_BYTES
        ),
        format!(
            "| tasks below a task | {} |",
            fab_compiler::MAX_EXTENDS_DEPTH
        ),
        format!(
            "| open brackets and braces | {} |",
            fab_grammar::MAX_NESTING
        ),
    ] {
        assert!(text.contains(&row), "{row}");
    }
}
