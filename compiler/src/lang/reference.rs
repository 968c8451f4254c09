//! The tables of the reference, written from the language's own tables.
//!
//! In: [`Vocabulary`]. Out: Markdown, one table a name. `docs/language.md` holds each between
//! `<!-- table: NAME -->` and `<!-- end -->`; [`refreshed`] writes them anew.

use super::vocabulary::{ArgumentEntry, CallEntry, Vocabulary, WordEntry, vocabulary};

const BEGIN: &str = "<!-- table: ";
const END: &str = "<!-- end -->";

/// Returns every table with its name.
pub fn tables() -> Vec<(&'static str, String)> {
    let known = vocabulary();
    let mut tables = vec![
        ("sections", sections(&known)),
        ("units", units(&known)),
        (
            "keywords",
            format!("```text\n{}\n```\n", wrapped(&known.keywords)),
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

/// The tables of calls: the name of each, and where its calls may stand.
const CALLS: &[(&str, &str)] = &[
    ("cloths", "cloth"),
    ("cameras", "camera"),
    ("points-of-the-cloth", "point of the cloth"),
    ("extractors", "extractor"),
    ("marks", "mark"),
    ("measures", "measure"),
];

/// The tables of words: the name of each, and its set.
const WORDS: &[(&str, &str)] = &[
    ("pickers", "picker"),
    ("goals", "goal"),
    ("fields", "field"),
    ("settings", "setting"),
    ("colours", "colour"),
    ("conditions", "condition"),
    ("comparisons", "comparison"),
    ("numbers-of-verify", "verify"),
    ("expectations", "expectation"),
];

/// Writes the tables of a page anew; what stands between other markers, or between none, is left alone.
///
/// Returns none where a table's end is missing.
pub fn refreshed(page: &str) -> Option<String> {
    let tables = tables();
    let mut text = String::with_capacity(page.len());
    let mut rest = page;
    while let Some((before, after)) = rest.split_once(BEGIN) {
        let (name, after) = after.split_once(" -->")?;
        let (old, after) = after.split_once(END)?;
        let table = tables.iter().find(|(known, _)| *known == name);
        let table = table.map_or_else(|| old.to_owned(), |(_, table)| format!("\n\n{table}\n"));
        text.push_str(&format!("{before}{BEGIN}{name} -->{table}{END}"));
        rest = after;
    }
    text.push_str(rest);
    Some(text)
}

fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|cell| (*cell).to_owned()).collect();
    let rows: String = rows.map(|row| line(&row)).collect();
    format!("{}|{}\n{rows}", line(&head), "---|".repeat(head.len()))
}

fn sections(known: &Vocabulary) -> String {
    let rows = known.sections.iter().map(|section| {
        let extends = match section.merges {
            "whole" => "replaces the whole section",
            "by_name" => "merges by name",
            "changes" => "changes what is inherited",
            _ => "is not inherited",
        };
        vec![
            format!("`{}`", section.form),
            section.doc.to_owned(),
            extends.to_owned(),
        ]
    });
    table(&["section", "says", "in a task that extends another"], rows)
}

fn units(known: &Vocabulary) -> String {
    let rows = known.units.iter().map(|unit| {
        vec![
            format!("`{}`", unit.name),
            unit.measures.to_owned(),
            unit.doc.to_owned(),
        ]
    });
    table(&["unit", "measures", "counts"], rows)
}

fn calls<'v>(calls: impl Iterator<Item = &'v CallEntry>) -> String {
    let rows = calls.map(|call| {
        let arguments: Vec<String> = call.arguments.iter().map(argument).collect();
        vec![
            format!("`{}`", call.form),
            call.gives.to_owned(),
            call.doc.to_owned(),
            arguments.join("; "),
        ]
    });
    table(&["form", "gives", "what it is", "arguments"], rows)
}

fn argument(argument: &ArgumentEntry) -> String {
    let accepted = match &argument.range {
        Some(range) if range.from_included => format!(", `{}` to `{}`", range.from, range.to),
        Some(range) => format!(", above `{}`, at most `{}`", range.from, range.to),
        // A longer set has a table of its own.
        None if !(1..=4).contains(&argument.words.len()) => String::new(),
        None => {
            let words: Vec<String> = argument
                .words
                .iter()
                .map(|word| format!("`{word}`"))
                .collect();
            format!(": {}", words.join(", "))
        }
    };
    let default = match argument.default.as_deref() {
        None => String::new(),
        Some("nothing") => " (may be left out)".to_owned(),
        Some(default) => format!(" (without it: {default})"),
    };
    format!("`{}`: {}{accepted}{default}", argument.name, argument.doc)
}

fn words<'v>(words: impl Iterator<Item = &'v WordEntry>) -> String {
    let rows = words.map(|word| {
        let range = word.range.as_ref();
        let range = range.map_or(String::new(), |it| {
            format!("; `{}` to `{}`", it.from, it.to)
        });
        vec![format!("`{}`", word.name), format!("{}{range}", word.doc)]
    });
    table(&["word", "means"], rows)
}

/// Writes words in lines that are not too long.
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
