//! Reads every answer of `answers/*.txt`, and compares what is read with what the case says.
//!
//! A file says what it is about, and holds cases. A case begins with `=== ` and what it shows, in words. Below are, one per
//! line: `action in SPACE` (of `answers/spaces.txt`) or `text BEFORE | AFTER`; then what is read; then `---` and the answer,
//! to the next case.
//!
//! - `is VALUE` and `repair WORDS` for each repair, or `refused FIELD: MESSAGE`, the first line of it, are compared exactly.
//! - `means VALUE` and `refused FIELD` leave repairs and the message open.
//!
//! Blank lines at the end are not part of an answer. With a line `escaped` above `---`, `\n`, `\r`, `\t`, `\\` and
//! `\u{…}` in the answer are characters, as in Rust.
//!
//! `FABC_ANSWERS=FOLDER` reads the files of another folder instead, and prints for each kind how many answers were read,
//! refused, and read as another value, and which. A file there without a heading is one case, named after the file, and
//! its answer is taken as it is; an answer may also be one that `refused or means VALUE`.

#![allow(clippy::unwrap_used)]

mod spaces;

use fab_program::pointing::Notation;
use fab_program::reply::{self, Malformed};
use fab_program::{ActionField, Proposal, space};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A case of a file.
struct Case {
    /// What it shows, in words, or the file's name.
    title: String,
    /// `action in SPACE` or `text BEFORE | AFTER`.
    kind: String,
    /// The lines between that and the answer.
    expected: String,
    answer: String,
}

/// How the answer of a case came out.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    Read,
    Refused,
    Another,
}

#[test]
fn every_answer_is_read_as_its_case_says() {
    let Some(other) = std::env::var_os("FABC_ANSWERS").map(PathBuf::from) else {
        return every_case_of_this_folder_holds();
    };
    let mut counts: BTreeMap<(String, Outcome), usize> = BTreeMap::new();
    for case in files(&other).iter().flat_map(|file| cases(file)) {
        let found = found(&case);
        let outcome = outcome(&found, &case.expected);
        let meant = match wanted(&case.expected) {
            Some(_) => "right",
            None => "to be refused",
        };
        let space = case.kind.split('|').next().unwrap_or_default().trim();
        *counts
            .entry((format!("{space}, {meant}"), outcome))
            .or_default() += 1;
        if outcome == Outcome::Another {
            println!("{}: {}  instead of {}", case.title, found, case.expected);
        }
    }
    let kinds: BTreeSet<&String> = counts.keys().map(|(kind, _)| kind).collect();
    for kind in kinds {
        let [read, refused, another] =
            [Outcome::Read, Outcome::Refused, Outcome::Another].map(|outcome| {
                let key = (kind.clone(), outcome);
                counts.get(&key).copied().unwrap_or_default()
            });
        println!("{kind}: {read} read, {refused} refused, {another} read as another value");
    }
}

fn every_case_of_this_folder_holds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/answers");
    let mut wrong = Vec::new();
    let (mut n_cases, mut n_exact) = (0, 0);
    let files = files(&folder);
    for file in files.iter().filter(|file| !file.ends_with("spaces.txt")) {
        let name = file.file_name().unwrap().to_string_lossy();
        let mut titles = BTreeSet::new();
        for case in cases(file) {
            n_cases += 1;
            n_exact += usize::from(case.expected.contains("repair ") || is_exact(&case.expected));
            assert!(titles.insert(case.title.clone()), "{name}: {}", case.title);
            let found = found(&case);
            if !is_as_expected(&found, &case.expected) {
                wrong.push(format!(
                    "{name}: {}\n  expected {}\n  found    {found}",
                    case.title, case.expected
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    assert!(n_cases > 500 && n_exact > 50, "{n_exact} of {n_cases}");
    assert!(n_cases <= 1000 && files.len() <= 16);
}

/// Returns the files of a folder, by name.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.is_file());
    files.sort();
    files
}

/// Returns the cases of a file.
fn cases(file: &Path) -> Vec<Case> {
    let text = fs::read_to_string(file).unwrap();
    let name = || file.file_name().unwrap().to_string_lossy().into_owned();
    let text = format!("\n{text}");
    let (before, packed) = text.split_once("\n=== ").unwrap_or((&text, ""));
    if packed.is_empty() || before.contains("\n---\n") {
        return vec![case(name(), &text[1..], str::to_owned)];
    }
    let titled = packed.split("\n=== ").map(|part| {
        let (title, rest) = part.split_once('\n').unwrap();
        let answer = |answer: &str| answer.trim_end_matches('\n').to_owned();
        case(title.to_owned(), rest, answer)
    });
    titled.collect()
}

fn case(title: String, text: &str, whole: impl Fn(&str) -> String) -> Case {
    let parts = text
        .split_once("\n---\n")
        .or(text.strip_suffix("\n---").map(|it| (it, "")));
    let (head, answer) = parts.unwrap_or_else(|| panic!("{title}: no line `---`"));
    let (kind, expected) = head.split_once('\n').unwrap();
    let plain = expected.strip_suffix("\nescaped");
    let answer = whole(answer);
    Case {
        title,
        kind: kind.to_owned(),
        expected: plain.unwrap_or(expected).to_owned(),
        answer: match plain {
            Some(_) => unescaped(&answer),
            None => answer,
        },
    }
}

/// Returns a text with `\n`, `\r`, `\t`, `\\` and `\u{…}` as characters.
fn unescaped(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('\\') {
        plain.push_str(before);
        let (letter, length) = match after.chars().next().unwrap() {
            'n' => ('\n', 1),
            'r' => ('\r', 1),
            't' => ('\t', 1),
            '\\' => ('\\', 1),
            _ => {
                let code = after.strip_prefix("u{").and_then(|it| it.split_once('}'));
                let code = code.unwrap_or_else(|| panic!("no escape: {after}")).0;
                let letter = u32::from_str_radix(code, 16).ok().and_then(char::from_u32);
                (letter.unwrap(), "u{}".len() + code.len())
            }
        };
        plain.push(letter);
        rest = &after[length..];
    }
    plain + rest
}

/// Reads the answer of a case: `is VALUE` and its repairs, or `refused FIELD: MESSAGE`.
fn found(case: &Case) -> String {
    match case.kind.strip_prefix("text ") {
        Some(pattern) => {
            let (before, after) = pattern.split_once('|').unwrap();
            let read = reply::read_text(before.trim(), after.trim(), &case.answer);
            described(read.map(|reading| (reading.value, reading.repairs)))
        }
        None => {
            let space = case.kind.strip_prefix("action in ").unwrap_or("points");
            let fields = spaces::space(space);
            let notation = Notation::pixels();
            let read = reply::read_fields(&fields, spaces::EDGE_M, &notation, &case.answer);
            described(read.map(|reading| (values(&fields, &reading.value), reading.repairs)))
        }
    }
}

fn described(read: Result<(String, Vec<String>), Malformed>) -> String {
    match read {
        Ok((value, repairs)) => {
            let repairs = repairs.iter().map(|repair| format!("\nrepair {repair}"));
            format!("is {value}{}", repairs.collect::<String>())
        }
        Err(Malformed { field, message, .. }) => {
            format!("refused {field}: {}", message.lines().next().unwrap())
        }
    }
}

fn values(fields: &[ActionField], proposal: &Proposal) -> String {
    let values = fields.iter().map(|field| {
        let value = proposal.get(&field.name).unwrap();
        format!("{} {}", field.name, space::text(field, value))
    });
    values.collect::<Vec<_>>().join(", ")
}

/// Returns the value that an answer means, if it has one.
fn wanted(expected: &str) -> Option<&str> {
    let line = expected.lines().next().unwrap();
    ["is ", "means ", "refused or means "]
        .iter()
        .find_map(|verb| line.strip_prefix(verb))
}

/// Returns whether repairs or the message are compared too.
fn is_exact(expected: &str) -> bool {
    expected.starts_with("is ") || expected.starts_with("refused") && expected.contains(": ")
}

fn outcome(found: &str, expected: &str) -> Outcome {
    let value = found
        .lines()
        .next()
        .and_then(|line| line.strip_prefix("is "));
    match value {
        None => Outcome::Refused,
        Some(value) if wanted(expected) == Some(value) => Outcome::Read,
        Some(_) => Outcome::Another,
    }
}

fn is_as_expected(found: &str, expected: &str) -> bool {
    if is_exact(expected) {
        return found == expected;
    }
    match expected.strip_prefix("refused ") {
        Some(field) => found.starts_with(&format!("refused {field}: ")),
        None => outcome(found, expected) == Outcome::Read,
    }
}
