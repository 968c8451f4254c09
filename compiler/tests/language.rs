//! The language reference tells the truth: its examples compile, its messages and its table of codes are real.

#![allow(clippy::unwrap_used)]

mod common;

use common::Memory;
use compiler::diag::{self, CODES, Color};
use std::fs;

/// A fenced block: the words behind its opening, its text, and the line on which it opens.
struct Block {
    kind: String,
    text: String,
    line: usize,
}

fn reference() -> String {
    fs::read_to_string(common::workspace().join("docs/language.md")).unwrap()
}

fn blocks(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for (index, line) in text.lines().enumerate() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(kind), None) => {
                open = Some(Block {
                    kind: kind.to_owned(),
                    text: String::new(),
                    line: index + 1,
                })
            }
            (None, Some(block)) => {
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, None) => {}
        }
    }
    blocks
}

/// Sections become those of a task that extends the reference's first example.
fn file_of(block: &Block) -> String {
    if block.kind == "fab" {
        return block.text.clone();
    }
    let sections: String = block
        .text
        .lines()
        .map(|line| format!("    {line}\n"))
        .collect();
    let experts = "experts folded { sequence { fold corner(back_left) -> corner(front_left) } }";
    format!("use \"half.fab\"\n{experts}\ntask example extends half {{\n{sections}}}\n")
}

#[test]
fn every_example_compiles() {
    let text = reference();
    let blocks = blocks(&text);
    let whole = blocks
        .iter()
        .find(|block| block.kind == "fab")
        .unwrap()
        .text
        .clone();
    let (mut n_examples, mut n_tests) = (0, 0);
    for (number, block) in blocks
        .iter()
        .enumerate()
        .filter(|(_, block)| block.kind.starts_with("fab"))
    {
        let files = Memory::of([("example.fab", &file_of(block)), ("half.fab", &whole)]);
        let compiled = compiler::compile("example.fab", &files).unwrap();
        let shown = diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain);
        if block.kind == "fab wrong" {
            assert_eq!(shown, blocks[number + 1].text, "line {}", block.line);
        } else {
            assert!(
                !compiled.has_errors() && !compiled.programs.is_empty(),
                "line {}:\n{shown}",
                block.line
            );
        }
        for test in &compiled.tests {
            let program = compiled
                .programs
                .iter()
                .find(|program| program.task == test.task && program.variant.is_none())
                .unwrap();
            let trial = compiler::trial::run(program, test);
            assert!(
                trial.is_expected,
                "line {}: {}: {}",
                block.line, test.name, trial.finding
            );
            n_tests += 1;
        }
        n_examples += 1;
    }
    assert!(n_examples > 20, "only {n_examples} examples were found");
    assert!(n_tests >= 3, "only {n_tests} tests were run");
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
    let listed = blocks(&text)
        .into_iter()
        .find(|block| block.kind == "text")
        .unwrap()
        .text;
    let listed: Vec<&str> = listed.split_whitespace().collect();
    let text = reference();
    let words = text
        .split(|character: char| !character.is_ascii_alphanumeric() && character != '_')
        .filter(|word| !word.is_empty());
    for word in words.filter(|word| word.starts_with(|first: char| first.is_ascii_alphabetic())) {
        assert_eq!(grammar::is_keyword(word), listed.contains(&word), "{word}");
    }
}

#[test]
fn limits_are_as_stated() {
    let text = reference();
    for row in [
        format!("| a file | {} KiB |", grammar::MAX_BYTES >> 10),
        format!(
            "| files in one compilation | {}, each {} `use`s deep |",
            compiler::MAX_FILES,
            compiler::MAX_USE_DEPTH
        ),
        format!(
            "| text in one compilation | {} KiB |",
            compiler::MAX_TOTAL_BYTES >> 10
        ),
        format!(
            "| letters of a word outside of texts | {} |",
            grammar::MAX_WORD_BYTES
        ),
        format!("| tasks below a task | {} |", compiler::MAX_EXTENDS_DEPTH),
        format!("| open brackets and braces | {} |", grammar::MAX_NESTING),
    ] {
        assert!(text.contains(&row), "{row}");
    }
}
