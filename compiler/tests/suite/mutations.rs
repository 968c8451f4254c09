//! No change to a task, and no order of the language's words, breaks an invariant of the compiler.
//!
//! The number of cases and the seeds are fixed, so a failure can be repeated; the fuzz target (`fuzz/`) searches
//! further.

use crate::chance::Chance;
use crate::inputs;
use crate::promises;
use std::fs;
use std::panic;
use std::path::Path;

/// The number of texts.
const CASES: u64 = 500;

/// The longest text, bytes: a debug build compiles a few hundred kilobytes a second.
const MOST_BYTES: usize = 2000;

/// Half of what Rust gives a thread. At the deepest nesting the parser needs most of it.
const STACK_BYTES: usize = 1 << 20;

impl Chance {
    fn of<'t, T: ?Sized>(&mut self, list: &[&'t T]) -> &'t T {
        list[self.below(list.len())]
    }
}

/// Returns the shipped tasks and every fixture of a fault.
fn texts() -> Vec<String> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut paths = Vec::new();
    for folder in ["tasks", "tasks/lib", "tests/fixtures/faults"] {
        let entries = fs::read_dir(workspace.join(folder)).unwrap();
        paths.extend(entries.map(|entry| entry.unwrap().path()));
    }
    paths.sort();
    let is_task = |path: &&std::path::PathBuf| path.extension().is_some_and(|it| it == "fab");
    let texts: Vec<String> = paths
        .iter()
        .filter(is_task)
        .map(|path| fs::read_to_string(path).unwrap())
        .collect();
    assert!(texts.len() > 10, "the tasks and fixtures are found");
    texts
}

/// Splits texts into words, signs and blanks, each of which can be put anywhere.
fn words(texts: &[String]) -> Vec<&str> {
    let is_end = |character: char| !character.is_alphanumeric() && character != '_';
    let mut words: Vec<&str> = texts
        .iter()
        .flat_map(|text| text.split_inclusive(is_end))
        .collect();
    words.sort_unstable();
    words.dedup();
    words.extend([
        "\"\"\"",
        "{{",
        "}}",
        "“",
        "”",
        "'",
        "\\",
        "\r\n",
        "\r",
        "\u{feff}",
        "\u{a0}",
        "→",
        "é",
        "#",
        "0",
        "-9e9mm",
        "\0",
        "use \"../a.fab\"\n",
        "use \"a.fab\"\n",
        "task x {\n",
        "}\n",
    ]);
    words
}

/// Returns the nearest boundary between characters at or before a byte.
fn boundary(text: &str, byte: usize) -> usize {
    text.floor_char_boundary(byte)
}

/// Returns a piece of a text, at most `most` bytes long.
fn piece<'t>(text: &'t str, most: usize, chance: &mut Chance) -> &'t str {
    let start = boundary(text, chance.below(text.len() + 1));
    let end = boundary(text, (start + chance.below(most)).min(text.len()));
    &text[start..end.max(start)]
}

/// Returns one case: a text with some changes, or words in any order.
fn case(number: u64, texts: &[String], words: &[&str]) -> String {
    let mut chance = Chance(number);
    if number.is_multiple_of(4) {
        let count = chance.below(200);
        return (0..count).map(|_| chance.of(words)).collect();
    }
    let base = &texts[chance.below(texts.len())];
    let mut text = base[..boundary(base, MOST_BYTES)].to_owned();
    for _ in 0..=chance.below(4) {
        let at = boundary(&text, chance.below(text.len() + 1));
        match chance.below(5) {
            0 => text.insert_str(at, chance.of(words)),
            1 => text.truncate(at),
            2 => {
                let end = boundary(&text, (at + chance.below(60)).min(text.len()));
                text.replace_range(at..end.max(at), chance.of(words));
            }
            3 => {
                let other = &texts[chance.below(texts.len())];
                text.insert_str(at, piece(other, 400, &mut chance));
            }
            _ => {
                let again = piece(&text, 120, &mut chance).repeat(chance.below(12));
                text.insert_str(at, &again);
            }
        }
    }
    text
}

#[test]
#[ignore = "long"]
fn changed_tasks_and_words_in_any_order_keep_every_promise() {
    let run = || {
        let texts = texts();
        let words = words(&texts);
        for number in 0..CASES {
            let text = case(number, &texts, &words);
            if panic::catch_unwind(|| promises::hold(&text)).is_err() {
                panic!("case {number} breaks a promise:\n{text}");
            }
        }
    };
    let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
    thread.spawn(run).unwrap().join().unwrap();
}

#[test]
#[ignore = "long"]
fn generated_inputs_keep_every_promise() {
    for input in inputs::all() {
        promises::hold(&input.text(1500));
    }
}
