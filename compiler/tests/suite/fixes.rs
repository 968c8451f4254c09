//! Checks which edits are applied, and that nothing else changes.
//!
//! In: `tests/fixtures/fixes`, found automatically. What `NAME.fab` becomes is in `NAME.fixed`; without that file it
//! stays as it is. Both use the libraries of the faults.

use crate::chance::Chance;
use crate::common::workspace;
use fab_compiler::diag::{self, Color, Diagnostic, Severity};
use fab_compiler::fix::{self, Fixed};
use fab_compiler::{Compiled, LoadError, Loader};
use std::collections::BTreeMap;
use std::fs;
use std::num::NonZero;
use std::ops::Range;
use std::thread;

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
    ("000", "_000"),
    ("000", ",000"),
    ("00", "0_0"),
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
    ("back_", "top_"),
    ("front_", "bottom_"),
    (" ", ""),
    (")", ""),
    ("(", "["),
    ("}", ""),
    ("a", "A"),
];

/// Where a text is changed by one slip, and what is written there.
type Slip = Vec<(Range<usize>, &'static str)>;

/// Returns one to four slips that do not overlap, the first of the given kind; both quotes of a pair may be wrong.
fn slips(text: &str, first: usize, seed: u64) -> Vec<Slip> {
    let mut chance = Chance(seed);
    let mut slips: Vec<Slip> = Vec::new();
    // More often few: of several slips, one mostly keeps the file from compiling.
    let n_more = chance.below(4).min(chance.below(4));
    for number in 0..=n_more {
        let kind = if number == 0 {
            first
        } else {
            chance.below(SLIPS.len())
        };
        let (right, wrong) = SLIPS[kind % SLIPS.len()];
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
        let places = places[index..end].iter();
        let slip: Slip = places.map(|at| (*at..at + right.len(), wrong)).collect();
        let overlap = |(place, _): &(Range<usize>, &str)| {
            let earlier = slips.iter().flatten();
            earlier
                .clone()
                .any(|(it, _)| it.start < place.end && place.start < it.end)
        };
        if !slip.iter().any(overlap) {
            slips.push(slip);
        }
    }
    slips
}

/// Returns a text with those slips whose bit is set.
fn with_slips(text: &str, slips: &[Slip], bits: usize) -> String {
    let chosen = slips.iter().enumerate();
    let chosen = chosen.filter(|(index, _)| bits >> index & 1 == 1);
    let mut changes: Vec<_> = chosen.flat_map(|(_, slip)| slip).collect();
    changes.sort_by_key(|(place, _)| place.start);
    let mut text = text.to_owned();
    // From the end, so earlier positions stay valid.
    for (place, wrong) in changes.into_iter().rev() {
        text.replace_range(place.clone(), wrong);
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

/// Findings by code and message: how often each was made.
type Counts<'a> = BTreeMap<(&'static str, &'a str), usize>;

/// Counts the findings that are alike.
fn counts(compiled: &Compiled) -> Counts<'_> {
    let mut counts = BTreeMap::new();
    for it in &compiled.diagnostics {
        *counts
            .entry((it.code.as_str(), it.message.as_str()))
            .or_default() += 1;
    }
    counts
}

/// A shipped file, as it is.
struct Shipped {
    /// Its name in the folder of shipped tasks.
    name: String,
    text: String,
    compiled: Compiled,
    /// A file that uses it and declares tasks that can run by themselves, and the hashes of their programs.
    user: String,
    programs: Vec<String>,
}

const SHIPPED: &str = "tasks";

/// Compiles a file with one text in place of a shipped one.
fn compiled(entry: &str, name: &str, text: &str) -> Compiled {
    let loader = Beside {
        folder: SHIPPED,
        name: name.to_owned(),
        text: text.to_owned(),
    };
    fab_compiler::compile(entry, &loader).unwrap()
}

impl Shipped {
    /// Returns every shipped file.
    fn all() -> Vec<Shipped> {
        let mut files = BTreeMap::new();
        for folder in ["", "lib/", "real/", "textiles/", "rehearsed/"] {
            for entry in fs::read_dir(workspace().join(SHIPPED).join(folder)).unwrap() {
                let path = entry.unwrap().path();
                // The paper's folds of a textile, those that are rehearsed, and the folds by parts of a side differ from
                // other folds of the recorded cloth in a line or two.
                let name = path.file_name().unwrap().to_string_lossy();
                let is_again = ["cotton_", "shop_fold", "thirds", "towel_"]
                    .iter()
                    .any(|it| name.starts_with(it))
                    || folder == "rehearsed/" && name != "double_triangle.fab";
                if path.extension().is_some_and(|it| it == "fab") && !is_again {
                    let name = format!("{folder}{name}");
                    let text = fs::read_to_string(path).unwrap();
                    let compiled = compiled(&name, &name, &text);
                    files.insert(name, (text, compiled));
                }
            }
        }
        let uses =
            |compiled: &Compiled, name: &str| compiled.sources.iter().any(|it| it.name == name);
        let all = files.iter().map(|(name, (text, compiled))| {
            let others = files.iter().map(|(name, (_, compiled))| (name, compiled));
            let mut users = [(name, compiled)].into_iter().chain(others);
            let user = users.find(|(_, it)| uses(it, name) && !it.programs.is_empty());
            let (user, its) = user.expect("some shipped task uses each library");
            Shipped {
                name: name.clone(),
                text: text.clone(),
                compiled: compiled.clone(),
                user: user.clone(),
                programs: hashes(its).expect("the shipped tasks have no errors"),
            }
        });
        all.collect()
    }

    /// Returns the programs that a text in place of this file gives; `None` if there is an error.
    fn programs_of(&self, text: &str) -> Option<Vec<String>> {
        hashes(&compiled(&self.user, &self.name, text))
    }
}

/// Returns the hash of each program, which covers its prompts; `None` if there is an error.
fn hashes(compiled: &Compiled) -> Option<Vec<String>> {
    let hashes = || compiled.programs.iter().map(|it| it.hash()).collect();
    (!compiled.has_errors()).then(hashes)
}

/// What was tried, and what was wrong.
#[derive(Default)]
struct Outcome {
    n_changed: usize,
    n_compared: usize,
    wrong: Vec<String>,
}

#[test]
fn a_fixed_task_keeps_every_number_name_and_text_and_its_programs() {
    slips_are_fixed_without_harm(300);
}

#[test]
#[ignore = "long"]
fn many_fixed_tasks_keep_every_number_name_and_text_and_their_programs() {
    slips_are_fixed_without_harm(3_000);
}

#[test]
fn no_shipped_file_has_an_error_or_a_warning() {
    for folder in ["", "lib/", "real/", "textiles/", "rehearsed/"] {
        for entry in fs::read_dir(workspace().join(SHIPPED).join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|it| it != "fab") {
                continue;
            }
            let name = format!("{folder}{}", path.file_name().unwrap().to_string_lossy());
            let found = compiled(&name, &name, &fs::read_to_string(path).unwrap()).diagnostics;
            let is_note = |it: &Diagnostic| it.severity == Severity::Note;
            assert!(found.iter().all(is_note), "{name}: {found:?}");
        }
    }
}

/// Fixes shipped files with slips, each kind of slip as often as the others.
fn slips_are_fixed_without_harm(n_cases: usize) {
    let files = Shipped::all();
    let n_threads = thread::available_parallelism().map_or(1, NonZero::get);
    let tried = &|first: usize| {
        let mut outcome = Outcome::default();
        for case in (first..n_cases).step_by(n_threads) {
            slip_is_fixed_without_harm(&files[case % files.len()], case, &mut outcome);
        }
        outcome
    };
    let (mut n_changed, mut n_compared, mut wrong) = (0, 0, Vec::new());
    thread::scope(|scope| {
        let threads: Vec<_> = (0..n_threads)
            .map(|first| scope.spawn(move || tried(first)))
            .collect();
        for thread in threads {
            let outcome = thread.join().unwrap();
            n_changed += outcome.n_changed;
            n_compared += outcome.n_compared;
            wrong.extend(outcome.wrong);
        }
    });
    assert!(
        wrong.is_empty(),
        "{} cases\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(
        n_changed > n_cases / 4,
        "only {n_changed} texts are changed"
    );
    assert!(n_compared > n_cases / 8, "only {n_compared} can run");
}

fn slip_is_fixed_without_harm(file: &Shipped, case: usize, outcome: &mut Outcome) {
    let name = &file.name;
    let slips = slips(&file.text, case, case as u64);
    let text = with_slips(&file.text, &slips, usize::MAX);
    let (once, fixed_once) = fixed(SHIPPED, name, &text);
    if once == text {
        return;
    }
    outcome.n_changed += 1;
    let wrong = &mut outcome.wrong;
    let mut fail = |why: &str| {
        let changes = changes(&text, &once);
        wrong.push(format!("{name}, case {case}: {why}\n{changes}"));
    };
    if content(&text) != content(&once) {
        fail("a number, name or text changes");
    }
    // Fixing applies the certain edits of what a text compiles to, so without any it would change nothing again.
    let findings = &fixed_once.compiled.diagnostics;
    if findings.iter().any(|it| it.is_certain()) {
        fail("fixing again would change it again");
    }
    // Compiling anew takes most of the time of this test.
    let is_fixed_twice = case.is_multiple_of(10);
    if is_fixed_twice && fixed(SHIPPED, name, &once).0 != once {
        fail("fixing again changes it again");
    }
    let [own, after] = [&file.compiled, &fixed_once.compiled].map(counts);
    let is_added = |known: &[&Counts<'_>]| {
        after.iter().any(|(key, count)| {
            let most = known.iter().filter_map(|counts| counts.get(key)).max();
            most.is_none_or(|most| most < count)
        })
    };
    // A slip keeps the file's own findings, and those of the other slips, from being looked for.
    let some_slips = (1..1 << slips.len()).rev();
    let with_some_slips = || -> Vec<Compiled> {
        let some = some_slips.map(|bits| with_slips(&file.text, &slips, bits));
        some.map(|text| compiled(name, name, &text)).collect()
    };
    if is_added(&[&own]) && {
        let known = with_some_slips();
        let known: Vec<Counts<'_>> = known.iter().map(counts).collect();
        is_added(&known.iter().collect::<Vec<_>>())
    } {
        fail("a finding is added");
    }
    if fixed_once.compiled.has_errors() {
        return;
    }
    let is_user = file.user == *name;
    let programs = if is_user && !is_fixed_twice {
        hashes(&fixed_once.compiled)
    } else {
        file.programs_of(&once)
    };
    let Some(programs) = programs else {
        return;
    };
    outcome.n_compared += 1;
    // A text without errors keeps its programs.
    if let Some(before) = file.programs_of(&text) {
        if before != programs {
            fail("the programs change");
        }
        return;
    }
    // Every slip is undone, or stays because it means something: `<` in place of `>`.
    let undone = |bits: usize| match bits {
        0 => file.programs == programs,
        _ => file.programs_of(&with_slips(&file.text, &slips, bits)) == Some(programs.clone()),
    };
    if !(0..1 << slips.len()).any(undone) {
        fail("the programs are not those of the file without some slips");
    }
}

/// Shows the lines that differ.
fn changes(before: &str, after: &str) -> String {
    let lines = before.lines().zip(after.lines());
    let differing = lines.filter(|(before, after)| before != after);
    differing
        .map(|(before, after)| format!("  - {before}\n  + {after}\n"))
        .collect()
}
