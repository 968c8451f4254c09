//! The tables of the reference, made from the language's own tables.
//!
//! In: [`Vocabulary`]. Out: Markdown, one table per name. `docs/language.md` holds each between
//! `<!-- table: NAME -->` and `<!-- end -->`.

use fab_compiler::diag::CODES;
use fab_compiler::lang::{CallEntry, Inheritance, Vocabulary, WordEntry, vocabulary};
use fab_program::exact::written;
use fab_program::units::base;
use fab_program::vocabulary::{Arg, Bound, Default, Kind, Place, Range, Word};

/// Returns every table with its name.
pub fn tables() -> Vec<(&'static str, String)> {
    let known = vocabulary();
    let mut tables = vec![
        ("sections", sections(&known)),
        ("codes", codes()),
        ("units", units(&known)),
        (
            "keywords",
            format!("```text\n{}\n```\n", wrapped(known.keywords)),
        ),
    ];
    for (name, kind) in CALLS {
        tables.push((
            name,
            calls(known.calls.iter().filter(|call| call.kind == *kind)),
        ));
    }
    for (name, set) in WORDS {
        tables.push((
            name,
            words(known.words.iter().filter(|word| word.set == *set)),
        ));
    }
    tables
}

/// The tables of calls: the name of each, and where its calls may be used.
const CALLS: &[(&str, &str)] = &[
    ("cloths", "cloth"),
    ("pickers-with-a-manner", "picker"),
    ("cameras", "camera"),
    ("properties", "property of a material"),
    ("points-of-the-cloth", "point of the cloth"),
    ("extractors", "extractor"),
    ("marks", "mark"),
    ("measures", "measure"),
    ("twins", "twin"),
];

/// The tables of words: the name of each, and its set of words.
const WORDS: &[(&str, &str)] = &[
    ("pickers", "picker"),
    ("goals", "goal"),
    ("fields", "field"),
    ("settings", "setting"),
    ("colours", "colour"),
    ("faces", "face"),
    ("conditions", "condition"),
    ("comparisons", "comparison"),
    ("numbers-of-verify", "verify"),
    ("expectations", "expectation"),
    ("measures-on-twins", "measure on a twin"),
    ("numbers-of-rehearse", "rehearse"),
];

fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|cell| (*cell).to_owned()).collect();
    let rows: String = rows.map(|row| line(&row)).collect();
    format!("{}|{}\n{rows}", line(&head), "---|".repeat(head.len()))
}

fn sections(known: &Vocabulary) -> String {
    let rows = known.sections.iter().map(|section| {
        let extends = match section.merges {
            Inheritance::Whole => "replaces the whole section",
            Inheritance::ByName => "merges by name",
            Inheritance::Changes => "changes what is inherited",
            Inheritance::Never => "is not inherited",
        };
        vec![
            format!("`{}`", section.form),
            section.doc.to_owned(),
            extends.to_owned(),
        ]
    });
    table(&["section", "says", "in a task that extends another"], rows)
}

fn codes() -> String {
    let rows = CODES.iter().map(|entry| {
        let (code, severity) = (entry.code.as_str(), entry.severity.as_str());
        vec![
            code.to_owned(),
            severity.to_owned(),
            entry.title().to_owned(),
        ]
    });
    table(&["code", "severity", "what"], rows)
}

fn units(known: &Vocabulary) -> String {
    let rows = known.units.iter().map(|unit| {
        vec![
            format!("`{}`", unit.name),
            unit.dimension.noun().to_owned(),
            unit.doc.to_owned(),
        ]
    });
    table(&["unit", "measures", "counts"], rows)
}

fn calls<'v>(calls: impl Iterator<Item = &'v CallEntry>) -> String {
    let rows = calls.map(|call| {
        let arguments: Vec<String> = call.signature.args.iter().map(argument).collect();
        vec![
            format!("`{}`", call.form),
            call.signature.gives.to_owned(),
            call.signature.doc.to_owned(),
            arguments.join("; "),
        ]
    });
    table(&["form", "gives", "what it is", "arguments"], rows)
}

fn argument(arg: &Arg) -> String {
    let default = match arg.default {
        None => String::new(),
        Some(Default::Nothing) => " (may be left out)".to_owned(),
        Some(Default::CameraSide) => " (without it: the camera's own side)".to_owned(),
        Some(Default::Word(word)) => format!(" (without it: `{word}`)"),
        Some(Default::Number(number)) => {
            let unit = range(arg.kind).map_or("", |range| range.to.1);
            let number = written(number / base((1.0, unit)), 3);
            format!(" (without it: `{number}{unit}`)")
        }
    };
    // As in the call's form, only labels are in lower case.
    let name = match arg.place {
        Place::Named => arg.name.to_owned(),
        Place::Positional | Place::Rest => arg.name.to_uppercase(),
    };
    format!("`{name}`: {}{}{default}", arg.doc, accepted(arg.kind))
}

/// Describes which numbers or words are accepted.
fn accepted(kind: Kind) -> String {
    // A larger set has a table of its own.
    const MOST: usize = 4;
    if let Some(range) = range(kind) {
        let [from, to] = [range.from, range.to].map(|(number, unit)| format!("`{number}{unit}`"));
        return match range.least {
            Bound::Included => format!(", {from} to {to}"),
            Bound::Excluded => format!(", above {from}, at most {to}"),
        };
    }
    let listed = |words: &[Word]| -> String {
        let words: Vec<String> = words
            .iter()
            .map(|word| format!("`{}`", word.name))
            .collect();
        words.join(", ")
    };
    match kind {
        Kind::WordOrCount {
            words, range, unit, ..
        } => format!(
            ": {}, or `{} {unit}` to `{} {unit}`",
            listed(words),
            range.from.0,
            range.to.0
        ),
        Kind::Word(words) | Kind::NameOf { words, .. } | Kind::WordOrFile { words, .. }
            if words.len() <= MOST =>
        {
            format!(": {}", listed(words))
        }
        _ => String::new(),
    }
}

fn range(kind: Kind) -> Option<Range> {
    match kind {
        Kind::Quantity(range)
        | Kind::Whole(range)
        | Kind::Odd(range)
        | Kind::Between(range)
        | Kind::DepthLimit(range) => Some(range),
        _ => None,
    }
}

fn words<'v>(words: impl Iterator<Item = &'v WordEntry>) -> String {
    let rows = words.map(|entry| {
        let value = entry.value.map_or(String::new(), accepted);
        vec![
            format!("`{}`", entry.word.name),
            format!("{}{value}", entry.word.doc),
        ]
    });
    table(&["word", "means"], rows)
}

/// Joins words into lines of limited length.
fn wrapped(words: &[&str]) -> String {
    const WIDTH: usize = 110;
    let mut lines: Vec<String> = vec![String::new()];
    for word in words {
        let line = lines.last().map_or(0, String::len);
        if line + word.len() >= WIDTH {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            line.push_str(if line.is_empty() { "" } else { " " });
            line.push_str(word);
        }
    }
    lines.join("\n")
}
