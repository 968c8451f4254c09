//! Checks every diagnostic against its fixture.
//!
//! In: the `.fab` files of `tests/fixtures/faults`; new ones are found automatically. Comments under a line state the
//! expected findings in it:
//!
//! ```text
//!     goal particle_distance < 40deg
//!     #                        ^^^^^ error[F0203]: expected a length on the table, found an angle
//! ```
//!
//! `# help: …` below it states one of its helps. The carets mark the columns; an empty span has one caret. For a span inside a text, over several lines, or in
//! another file, a comment anywhere says `# at FILE:LINE:COLUMN error[…]: …` instead. All findings must be expected,
//! and all expectations found.

use crate::common;
use fab_compiler::diag::{self, CODES, Color, Diagnostic, Severity};
use fab_compiler::{Compiled, Listed, LoadError, Loader, Wanted};
use fab_program::{Material, Trial};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

/// Codes that need more input than a fixture should have; the compiler's own tests show them.
const TOO_LARGE_FOR_A_FIXTURE: [&str; 2] = ["F0001", "F0004"];

#[test]
fn every_fault_is_reported_as_its_fixture_says() {
    let mut wrong = Vec::new();
    for name in fixtures() {
        let text = Fixtures.load(&name).expect("a listed fixture can be read");
        let compiled =
            fab_compiler::compile(&name, &Fixtures).expect("a listed fixture can be read");
        let expected = expectations(&name, &text);
        let found: BTreeSet<Finding> = compiled
            .diagnostics
            .iter()
            .map(|it| finding(it, &compiled))
            .collect();
        let missing = expected
            .difference(&found)
            .map(|finding| format!("  expected {finding:?}"));
        let surplus = found
            .difference(&expected)
            .map(|finding| format!("  found    {finding:?}"));
        let helps = helps(&text).into_iter().filter(|(place, help)| {
            let mut all = compiled.diagnostics.iter();
            !all.any(|it| {
                let source = compiled.sources.get(it.span.file);
                source.name == name
                    && source.line_and_column(it.span.start) == *place
                    && it.help.contains(help)
            })
        });
        let helps = helps.map(|((line, _), help)| format!("  expected help, line {line}: {help}"));
        let differences: Vec<String> = missing.chain(surplus).chain(helps).collect();
        if !differences.is_empty() {
            let shown = diag::to_text(&compiled.diagnostics, &compiled.sources, Color::Plain);
            wrong.push(format!("{name}:\n{}\n{shown}", differences.join("\n")));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_code_has_a_fixture() {
    let shown: BTreeSet<String> = fixtures()
        .iter()
        .flat_map(|name| {
            expectations(
                name,
                &Fixtures.load(name).expect("a listed fixture can be read"),
            )
        })
        .map(|finding| finding.code)
        .collect();
    let all = CODES.iter().map(|entry| entry.code.as_str());
    let lacking: Vec<&str> = all
        .filter(|code| !shown.contains(*code) && !TOO_LARGE_FOR_A_FIXTURE.contains(code))
        .collect();
    assert!(lacking.is_empty(), "no fixture shows {lacking:?}");
    let known: Vec<&str> = TOO_LARGE_FOR_A_FIXTURE
        .into_iter()
        .filter(|code| shown.contains(*code))
        .collect();
    assert!(known.is_empty(), "{known:?} have fixtures after all");
}

#[test]
fn an_edit_repairs_what_it_is_offered_for() {
    for name in fixtures() {
        let compiled =
            fab_compiler::compile(&name, &Fixtures).expect("a listed fixture can be read");
        for (number, diagnostic) in compiled
            .diagnostics
            .iter()
            .enumerate()
            .filter(|(_, it)| !it.edits.is_empty())
        {
            let mut text = compiled.sources.get(diagnostic.span.file).text.clone();
            for edit in diagnostic.edits.iter().rev() {
                text.replace_range(edit.span.range(), &edit.replacement);
            }
            let edited_name = compiled.sources.get(diagnostic.span.file).name.clone();
            let edited = Edited {
                name: edited_name,
                text,
            };
            let again =
                fab_compiler::compile(&name, &edited).expect("a listed fixture can be read");
            let is_there = again.diagnostics.iter().any(|it| {
                (it.code, it.span.start, &it.message)
                    == (diagnostic.code, diagnostic.span.start, &diagnostic.message)
            });
            assert!(
                !is_there,
                "{name}: finding {number} stays after its edit: {}",
                diagnostic.message
            );
            // Errors of form hide the others.
            let errors = |compiled: &Compiled| {
                let all = compiled.diagnostics.iter();
                let errors = all.filter(|it| it.severity == Severity::Error);
                let is_form = |it: &&Diagnostic| it.code.as_str().starts_with("F01");
                let (form, other): (Vec<_>, Vec<_>) = errors.partition(is_form);
                (form.len(), other.len())
            };
            assert!(
                errors(&again) <= errors(&compiled),
                "{name}: the edit of finding {number} adds errors: {}\n{}",
                diagnostic.message,
                diag::to_text(&again.diagnostics, &again.sources, Color::Plain)
            );
        }
    }
}

/// Places where a suggested text may stand; `@` is the text.
const PLACES: &[&str] = &[
    "@",
    "task a { @ }",
    "task a { goal @ }",
    "task a { goal b @ 1mm }",
    "task a { goal b < 1mm @ c < 1mm }",
    "task a { goal b @ }",
    "task a { goal 1@ }",
    "task a { cloth b(@) }",
    "task a { keypoints { @ } }",
    "task a { keypoints { b @ c } }",
    "task a { actions { @ } }",
    "task a { actions { b @ one of c } }",
    "task a { component b @ \"c\" }",
    "task a { component b \"@\" }",
    "task a { @ b \"c\" }",
    "task a { stage b { @ } }",
    "task a { verify { @ } }",
    "task a { verify { @ { pick } else \"c\" } }",
    "task a { verify { check b { pick } @ } }",
    "task a { test \"b\" { @ } }",
    "material a { @ }",
    "material a { b 1 @ }",
    "material a { b 1 @ \"c\" }",
    "experts a { @ }",
    "experts a { sequence { fold b @ c } }",
    "task a { subgoals { @ } }",
];

/// Returns the texts that a message tells the author to write.
fn suggested(diagnostic: &Diagnostic) -> impl Iterator<Item = &str> {
    diagnostic.help.iter().flat_map(|help| {
        // A piece may itself have backticks only at its ends.
        help.split("write `").skip(1).filter_map(|rest| {
            let end = rest.find('`')?;
            Some(&rest[..end])
        })
    })
}

fn parses(text: &str) -> bool {
    let mut sources = fab_grammar::Sources::default();
    let file = sources.add("piece.fab".to_owned(), text.to_owned());
    fab_grammar::parse(file, text).faults.is_empty()
}

#[test]
fn what_a_message_tells_to_write_can_be_written() {
    let mut wrong = BTreeSet::new();
    let mut seen = 0;
    for name in fixtures() {
        let compiled =
            fab_compiler::compile(&name, &Fixtures).expect("a listed fixture can be read");
        for diagnostic in &compiled.diagnostics {
            for piece in suggested(diagnostic) {
                seen += 1;
                // Uppercase words are names to fill in.
                let filled = piece
                    .replace("\"…\"", "\"b\"")
                    .replace("\"#RRGGBB\"", "\"b\"")
                    .replace('…', "b")
                    .replace('#', "\n");
                let fits = PLACES
                    .iter()
                    .any(|place| parses(&place.replace('@', &filled)));
                if !fits {
                    wrong.insert(format!("{name}: {} -> `{piece}`", diagnostic.message));
                }
            }
        }
    }
    assert!(seen > 80, "{seen} suggestions");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// One finding, as a fixture can state it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Finding {
    file: String,
    line: usize,
    column: usize,
    /// 0 if the fixture states only the beginning.
    width: usize,
    severity: String,
    code: String,
    message: String,
}

fn finding(diagnostic: &Diagnostic, compiled: &Compiled) -> Finding {
    let source = compiled.sources.get(diagnostic.span.file);
    let (line, column) = source.line_and_column(diagnostic.span.start);
    let marked = &source.text[diagnostic.span.range()];
    // A span that a comment cannot mark is stated only by its beginning.
    let is_markable =
        !marked.contains('\n') && !is_inside_text(&source.text, diagnostic.span.start);
    Finding {
        file: source.name.clone(),
        line,
        column,
        width: if is_markable {
            marked.chars().count().max(1)
        } else {
            0
        },
        severity: diagnostic.severity.as_str().to_owned(),
        code: diagnostic.code.as_str().to_owned(),
        message: diagnostic.message.clone(),
    }
}

/// Reads the expectations of a fixture.
fn expectations(name: &str, text: &str) -> BTreeSet<Finding> {
    let mut found = BTreeSet::new();
    let mut judged = 0;
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let Some(comment) = line.trim_start().strip_prefix('#') else {
            judged = number;
            continue;
        };
        let comment = comment.trim_start();
        if let Some(placed) = comment.strip_prefix("at ") {
            found.extend(placed_expectation(placed));
        } else if comment.starts_with('^') {
            let carets = comment
                .chars()
                .take_while(|character| *character == '^')
                .count();
            let column = line
                .chars()
                .take_while(|character| *character != '^')
                .count()
                + 1;
            let stated = stated(comment[carets..].trim())
                .unwrap_or_else(|| panic!("{name}:{number}: not an expectation"));
            let (severity, code, message) = stated;
            found.insert(Finding {
                file: name.to_owned(),
                line: judged,
                column,
                width: carets,
                severity,
                code,
                message,
            });
        }
    }
    found
}

/// Reads the helps of a fixture, each with the line and the column of its finding.
fn helps(text: &str) -> Vec<((usize, usize), String)> {
    let (mut judged, mut column) = (0, 0);
    let mut found = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let comment = line.trim_start().strip_prefix('#').map(str::trim_start);
        match comment {
            None => judged = index + 1,
            Some(comment) if comment.starts_with('^') => {
                column = line.chars().take_while(|it| *it != '^').count() + 1;
            }
            Some(comment) => {
                let help = comment.strip_prefix("help: ");
                found.extend(help.map(|help| ((judged, column), help.to_owned())));
            }
        }
    }
    found
}

/// Reads `FILE:LINE:COLUMN error[F0111]: …`.
fn placed_expectation(text: &str) -> Option<Finding> {
    let (place, rest) = text.split_once(' ')?;
    let mut parts = place.split(':');
    let (file, line, column) = (
        parts.next()?,
        parts.next()?.parse().ok()?,
        parts.next()?.parse().ok()?,
    );
    let (severity, code, message) = stated(rest)?;
    Some(Finding {
        file: file.to_owned(),
        line,
        column,
        width: 0,
        severity,
        code,
        message,
    })
}

/// Reads `error[F0203]: message`.
fn stated(text: &str) -> Option<(String, String, String)> {
    let (head, message) = text.split_once("]: ")?;
    let (severity, code) = head.split_once('[')?;
    Some((severity.to_owned(), code.to_owned(), message.to_owned()))
}

/// Returns whether a byte is between triple quotes, where a comment would be part of the text.
fn is_inside_text(text: &str, at: usize) -> bool {
    text[..at].matches("\"\"\"").count() % 2 == 1
}

fn fixtures() -> Vec<String> {
    let folder = folder();
    let entries =
        fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut names: Vec<String> = entries
        .map(|entry| {
            entry
                .expect("the folder can be listed")
                .file_name()
                .into_string()
                .expect("names are UTF-8")
        })
        .filter(|name| name.ends_with(".fab"))
        .collect();
    names.sort();
    assert!(!names.is_empty(), "there is no fixture");
    names
}

fn folder() -> PathBuf {
    common::workspace().join("tests/fixtures/faults")
}

struct Fixtures;

impl Fixtures {
    /// What `fabc subgoals` found of the fixtures' demonstrations, by title.
    fn trials() -> BTreeMap<String, Trial> {
        let text = fs::read_to_string(folder().join("trials.json")).expect("a file of trials");
        serde_json::from_str(&text).expect("trials by title")
    }
}

impl Loader for Fixtures {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        fs::read_to_string(folder().join(name)).map_err(|_| LoadError {
            message: format!("there is no file `{name}`"),
        })
    }

    /// The files below `listed`; other fixtures name files that need not be there.
    fn look(&self, path: &str, _wanted: Wanted) -> Listed {
        match path.strip_prefix("listed/") {
            None => Listed::Unknown,
            Some("224.png") => Listed::Picture {
                width: 224,
                height: 224,
            },
            Some("wide.png") => Listed::Picture {
                width: 224,
                height: 200,
            },
            Some("demos.jsonl" | "start.npy") => Listed::Other,
            Some(_) => Listed::Nothing("no such file".to_owned()),
        }
    }

    fn trial(&self, title: &str) -> Option<Trial> {
        Fixtures::trials().remove(title)
    }

    /// A simulator for cloths that bend less than a board.
    fn refuses_cloth(&self, material: &Material, _spacing_m: f64) -> Option<String> {
        (material.name == "board").then(|| "a board is too stiff".to_owned())
    }
}

/// The fixtures, with one of them changed.
struct Edited {
    name: String,
    text: String,
}

impl Loader for Edited {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        if name == self.name {
            Ok(self.text.clone())
        } else {
            Fixtures.load(name)
        }
    }

    fn look(&self, path: &str, wanted: Wanted) -> Listed {
        Fixtures.look(path, wanted)
    }

    fn trial(&self, title: &str) -> Option<Trial> {
        Fixtures.trial(title)
    }

    fn refuses_cloth(&self, material: &Material, spacing_m: f64) -> Option<String> {
        Fixtures.refuses_cloth(material, spacing_m)
    }
}
