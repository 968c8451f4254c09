//! Tests that the table of settings is complete, and that the page is printed from it.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::settings::Settings;
use std::path::Path;

const BEGIN: &str = "<!-- settings: FABC_WRITE_DOCS=1 cargo test -p fab-arm --lib settings -->\n";
const END: &str = "<!-- end of settings -->\n";

#[test]
fn the_page_shows_every_setting() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/arm-settings.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once(BEGIN).unwrap();
    let (there, after) = rest.split_once(END).unwrap();
    let page = page();
    if std::env::var_os("FABC_WRITE_DOCS").is_some() {
        std::fs::write(&path, [before, BEGIN, &page, END, after].concat()).unwrap();
    } else {
        assert!(
            there == page,
            "write it: FABC_WRITE_DOCS=1 cargo test -p fab-arm --lib settings"
        );
    }
}

#[test]
fn every_default_is_accepted_by_its_own_row() {
    for key in KEYS {
        if let Is(default) = key.absent {
            let value = value_of(default);
            let is_empty_list = matches!(key.accepts, Sections) && default == "[]";
            assert!(is_empty_list || key.accepts.takes(&value), "{}", key.name);
        }
        assert!(
            !key.why.is_empty() && !key.why.contains('|'),
            "{}",
            key.name
        );
        let twice = KEYS.iter().filter(|other| other.name == key.name);
        assert_eq!(twice.count(), 1, "{}", key.name);
    }
}

/// Prints the table of the keys, section by section, in Markdown.
fn page() -> String {
    let mut page = String::new();
    let mut last = None;
    for key in KEYS {
        let (section, name) = match (&key.accepts, key.name.rsplit_once('.')) {
            (Section, _) | (_, None) => (key.name, key.name),
            (_, Some((section, name))) => (section, name),
        };
        let section = match key.name.contains('.') || matches!(key.accepts, Section) {
            true => section,
            false => "",
        };
        if last != Some(section) {
            let title = match section {
                "" => "\n## At the top of the file\n".to_owned(),
                list if is_list(list) => format!("\n## `[[{list}]]`\n"),
                section => format!("\n## `[{section}]`\n"),
            };
            _ = writeln!(page, "{title}");
            if let Some(own) = KEYS.iter().find(|key| key.name == section) {
                _ = writeln!(page, "{}.\n", capitalized(own.why));
            }
            page.push_str("| key | values | default | why |\n|---|---|---|---|\n");
            last = Some(section);
        }
        if matches!(key.accepts, Section) {
            continue;
        }
        let default = match key.absent {
            Refused => "must be given".to_owned(),
            Nothing => "none".to_owned(),
            Is(value) => format!("`{value}`"),
        };
        _ = writeln!(
            page,
            "| `{name}` | {} | {default} | {} |",
            key.expected(),
            key.why
        );
    }
    page.trim_start().to_owned()
}

fn is_list(name: &str) -> bool {
    KEYS.iter()
        .any(|key| key.name == name && matches!(key.accepts, Sections))
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map(|first| first.to_uppercase().chain(letters).collect())
        .unwrap_or_default()
}

/// A value that the row accepts.
fn sample(accepts: &Accepts) -> String {
    let number = |range: &Range| format!("{:?}", range.most.min(1e5));
    let list = |count: usize, one: String| format!("[{}]", vec![one; count].join(", "));
    match accepts {
        Text(begins) => format!("'{begins}x'"),
        Texts => "['x']".to_owned(),
        OneOf(words) => format!("'{}'", words[0]),
        Number(range) => number(range),
        Numbers(count, range) => list(*count, number(range)),
        AnyNumbers(range) => list(2, number(range)),
        Whole(_, most) => most.to_string(),
        Wholes(count, _, most) => list(*count, most.to_string()),
        Section => "{}".to_owned(),
        Sections => "[{}]".to_owned(),
    }
}

/// A row without a field would be refused, or ignored, by what is read after the table; a field without a row could not
/// be set.
#[test]
fn the_rows_are_the_fields_of_the_settings() {
    let mut whole = Table::new();
    for key in KEYS {
        let mut inner = &mut whole;
        let mut parts: Vec<&str> = key.name.split('.').collect();
        let last = parts.pop().unwrap();
        for part in parts {
            let next = inner.entry(part).or_insert(Value::Table(Table::new()));
            let next = match next {
                Value::Array(all) => &mut all[0],
                table => table,
            };
            inner = next.as_table_mut().unwrap();
        }
        inner.insert(last.to_owned(), value_of(&sample(&key.accepts)));
    }
    let read: Result<Settings, _> = whole.clone().try_into();
    read.unwrap();
    // serde lists a section's fields when it meets one that it does not know.
    let sections = KEYS
        .iter()
        .filter_map(|key| key.name.rsplit_once('.').map(|(section, _)| section));
    for section in sections.chain([""]) {
        let mut strange = whole.clone();
        let mut inner = &mut strange;
        for part in section.split('.').filter(|part| !part.is_empty()) {
            let next = match inner.get_mut(part).unwrap() {
                Value::Array(all) => &mut all[0],
                table => table,
            };
            inner = next.as_table_mut().unwrap();
        }
        inner.insert("nowhere".to_owned(), Value::Integer(1));
        let read: Result<Settings, _> = strange.try_into();
        let why = read.unwrap_err().to_string();
        let (_, listed) = why.lines().next().unwrap().split_once("expected").unwrap();
        let mut fields: Vec<&str> = listed.split('`').skip(1).step_by(2).collect();
        let prefix = match section {
            "" => String::new(),
            section => format!("{section}."),
        };
        let mut rows = names_in(&prefix);
        fields.sort_unstable();
        rows.sort_unstable();
        assert_eq!(fields, rows, "[{section}]: {why}");
    }
}
