//! Checks which edits are applied, and that nothing else changes.
//!
//! In: `tests/fixtures/fixes`, found automatically. What `NAME.fab` becomes is in `NAME.fixed`; without that file it
//! stays as it is. Both use the libraries of the faults.

#![allow(clippy::unwrap_used)]

mod common;

use common::workspace;
use fab_compiler::diag::{self, Color};
use fab_compiler::fix::{self, Fixed};
use fab_compiler::{LoadError, Loader};
use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;

/// One text, and the files of a folder.
struct Beside {
    folder: &'static str,
    name: String,
    text: String,
}

impl Loader for Beside {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        if name == self.name {
            return Ok(self.text.clone());
        }
        fs::read_to_string(workspace().join(self.folder).join(name)).map_err(|error| LoadError {
            message: format!("{name}: {error}"),
        })
    }
}

/// Fixes one text; the files that it uses may not change.
fn fixed(folder: &'static str, name: &str, text: &str) -> (String, Fixed) {
    let loader = Beside {
        folder,
        name: name.to_owned(),
        text: text.to_owned(),
    };
    let fixed = fix::fix(name, &loader, &|file| file == name).unwrap();
    let file = fixed.files.get(name);
    let text = file.map_or(text.to_owned(), |file| file.text.clone());
    (text, fixed)
}

#[test]
fn each_fixture_becomes_what_its_author_meant_or_stays() {
    let folder = workspace().join("tests/fixtures/fixes");
    let mut wrong = Vec::new();
    let mut n_fixtures = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|it| it != "fab") {
            continue;
        }
        n_fixtures += 1;
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).unwrap();
        let expected = fs::read_to_string(path.with_extension("fixed")).unwrap_or(text.clone());
        let (found, fixed) = fixed("tests/fixtures/faults", &name, &text);
        let compiled = &fixed.compiled;
        let shown = diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain);
        if found != expected {
            wrong.push(format!("{name} becomes\n{found}\n{shown}"));
        }
        if expected != text && compiled.has_errors() {
            wrong.push(format!("{name} keeps errors\n{shown}"));
        }
        if compiled.diagnostics.iter().any(|it| it.is_certain()) {
            wrong.push(format!("{name}: an edit is still called certain\n{shown}"));
        }
    }
    assert!(n_fixtures > 20, "the fixtures are found");
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// A pseudo-random sequence that is the same each time (SplitMix64).
struct Chance(u64);

impl Chance {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % end.max(1) as u64) as usize
    }
}

/// What is written, and what a slip makes of it. Some slips can only mean one thing; others can mean several.
const SLIPS: &[(&str, &str)] = &[
    (" and ", " && "),
    (" and ", "&&"),
    (" and ", " & "),
    (" or ", "||"),
    ("not ", "!"),
    ("# ", "// "),
    (" = ", " : "),
    (" = ", " := "),
    (" = ", " == "),
    (": ", " = "),
    (": ", " := "),
    (" -> ", " → "),
    (" -> ", "=>"),
    (" -> ", " to "),
    ("->", "–>"),
    (", ", "; "),
    (", ", ","),
    (", ", ",, "),
    (")\n", ");\n"),
    (")\n", "),\n"),
    ("\n", ";\n"),
    ("\n", ",\n"),
    ("0.", "."),
    (".", ","),
    (".0", ".0.0"),
    ("0", "_000"),
    ("0", ",000"),
    ("0", "0_0"),
    ("5", "5,0"),
    ("deg", "°"),
    ("deg", " degrees"),
    ("mm", " millimetres"),
    ("px", " pixels"),
    ("\"\"\"", "'''"),
    ("\"\"\"", "“““"),
    ("\"", "'"),
    ("\"", "“"),
    ("\"", "’"),
    ("\"", "”"),
    ("e ", "e'"),
    (" <= ", " ≤ "),
    (" > ", " >= = "),
    (" > ", " => "),
    (" < ", " =< "),
    (" > ", " < "),
    ("{ ", "{ !"),
    ("back_", "top_"),
    ("front_", "bottom_"),
    (" ", ""),
    (")", ""),
    ("(", "["),
    ("}", ""),
    ("a", "A"),
];

/// Returns the text with one to four slips, the first of them given; pairs of quotes may both be written wrong.
fn with_slips(text: &str, first: usize, seed: u64) -> String {
    let mut chance = Chance(seed);
    let mut text = text.to_owned();
    for number in 0..=chance.below(4) {
        let slip = if number == 0 {
            first
        } else {
            chance.below(SLIPS.len())
        };
        let (right, wrong) = SLIPS[slip % SLIPS.len()];
        let places: Vec<usize> = text.match_indices(right).map(|(at, _)| at).collect();
        if places.is_empty() {
            continue;
        }
        let index = chance.below(places.len());
        let end = if right.starts_with('"') && chance.below(2) == 0 {
            (index + 2).min(places.len())
        } else {
            index + 1
        };
        // From the end, so earlier positions stay valid.
        for at in places[index..end].iter().rev() {
            text.replace_range(*at..at + right.len(), wrong);
        }
    }
    text
}

/// Returns the numbers, names and words of a text, each number with its value, each unit by its name.
///
/// An apostrophe between letters belongs to its word. Words that others write as signs are left out.
fn content(text: &str) -> Vec<String> {
    let characters: Vec<char> = text.chars().collect();
    let at = |index: usize| characters.get(index).copied().unwrap_or(' ');
    let mut content = Vec::new();
    let mut start = 0;
    while start < characters.len() {
        let begins_number =
            at(start).is_ascii_digit() || at(start) == '.' && at(start + 1).is_ascii_digit();
        let mut end = start + 1;
        if begins_number {
            while at(end).is_ascii_digit()
                || "._,".contains(at(end)) && at(end + 1).is_ascii_digit()
            {
                end += 1;
            }
        } else if at(start).is_alphabetic() || "_°".contains(at(start)) {
            while at(end).is_alphanumeric()
                || at(end) == '_'
                || "'’\"".contains(at(end))
                    && at(end - 1).is_alphabetic()
                    && at(end + 1).is_alphabetic()
            {
                end += 1;
            }
        } else {
            start = end;
            continue;
        }
        let word: String = characters[start..end].iter().collect();
        content.push(match word.as_str() {
            "and" | "or" | "not" | "to" => String::new(),
            "°" | "degrees" => "deg".to_owned(),
            "millimetres" => "mm".to_owned(),
            "pixels" => "px".to_owned(),
            _ if begins_number => {
                let plain = word.replace('_', "");
                plain
                    .strip_prefix('.')
                    .map_or(plain.clone(), |rest| format!("0.{rest}"))
            }
            _ => word,
        });
        start = end;
    }
    content.retain(|word| !word.is_empty());
    content
}

/// Counts the findings that are alike.
fn counts(compiled: &fab_compiler::Compiled) -> BTreeMap<(&'static str, &str), usize> {
    let mut counts = BTreeMap::new();
    for it in &compiled.diagnostics {
        *counts
            .entry((it.code.as_str(), it.message.as_str()))
            .or_default() += 1;
    }
    counts
}

#[test]
fn a_fixed_task_keeps_every_number_name_and_text() {
    slips_are_fixed_without_harm(0..12);
}

#[test]
#[ignore = "long"]
fn many_fixed_tasks_keep_every_number_name_and_text() {
    slips_are_fixed_without_harm(100..400);
}

/// Fixes each shipped task with the slips of each seed.
fn slips_are_fixed_without_harm(seeds: Range<u64>) {
    let (mut n_cases, mut n_changed) = (0, 0);
    let mut wrong = Vec::new();
    for folder in ["tasks", "tasks/lib"] {
        for entry in fs::read_dir(workspace().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|it| it != "fab") {
                continue;
            }
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let original = fs::read_to_string(&path).unwrap();
            for seed in seeds.clone() {
                let text = with_slips(&original, n_cases, seed);
                n_cases += 1;
                let (once, fixed_once) = fixed(folder, &name, &text);
                n_changed += usize::from(once != text);
                let mut fail = |why: &str| {
                    wrong.push(format!(
                        "{folder}/{name}, seed {seed}: {why}\n{}",
                        changes(&text, &once)
                    ))
                };
                if content(&text) != content(&once) {
                    fail("a number, name or text changes");
                }
                if fixed(folder, &name, &once).0 != once {
                    fail("fixing again changes it again");
                }
                let loader = Beside {
                    folder,
                    name: name.clone(),
                    text: text.clone(),
                };
                let compiled = fab_compiler::compile(&name, &loader).unwrap();
                let before = counts(&compiled);
                // The slips kept these from being looked for.
                let loader = Beside {
                    folder,
                    name: name.clone(),
                    text: original.clone(),
                };
                let unharmed = fab_compiler::compile(&name, &loader).unwrap();
                let uncovered = counts(&unharmed);
                let after = counts(&fixed_once.compiled);
                if after.iter().any(|(key, count)| {
                    before
                        .get(key)
                        .max(uncovered.get(key))
                        .is_none_or(|it| it < count)
                }) {
                    fail("a finding is added");
                }
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{} cases\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(n_changed > 20, "only {n_changed} texts are changed");
}

/// Shows the lines that differ.
fn changes(before: &str, after: &str) -> String {
    let lines = before.lines().zip(after.lines());
    let differing = lines.filter(|(before, after)| before != after);
    differing
        .map(|(before, after)| format!("  - {before}\n  + {after}\n"))
        .collect()
}
