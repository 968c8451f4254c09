//! Tests that each default is accepted, and that the page is printed from the declarations.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::settings::Settings;
use std::fmt::Write as _;
use std::path::Path;

const BEGIN: &str = "<!-- settings: FABC_WRITE_DOCS=1 cargo test -p fab-arm --lib settings -->\n";
const END: &str = "<!-- end of settings -->\n";

fn keys() -> Vec<Key> {
    match Settings::accepts(ANY) {
        Accepts::Section(keys) => keys,
        _ => panic!("settings are a section"),
    }
}

#[test]
fn the_page_shows_every_setting() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/arm-settings.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = text.split_once(BEGIN).unwrap();
    let (there, after) = rest.split_once(END).unwrap();
    let mut page = "## At the top of the file\n".to_owned();
    print(&mut page, &keys(), "");
    if std::env::var_os("FABC_WRITE_DOCS").is_some() {
        std::fs::write(&path, [before, BEGIN, &page, END, after].concat()).unwrap();
    } else {
        assert!(
            there == page,
            "write it: FABC_WRITE_DOCS=1 cargo test -p fab-arm --lib settings"
        );
    }
}

/// Prints the table of a section's keys in Markdown, then the sections in it.
fn print(page: &mut String, keys: &[Key], prefix: &str) {
    page.push_str("\n| key | values | default | why |\n|---|---|---|---|\n");
    let mut inner = Vec::new();
    for key in keys {
        let (name, why) = (key.name, &key.why);
        let full = format!("{prefix}{name}");
        if let Some(keys) = key.accepts.keys() {
            let is_list = matches!(key.accepts, Accepts::List(..));
            let title = if is_list {
                format!("[[{full}]]")
            } else {
                format!("[{full}]")
            };
            inner.push((title, why, keys, full));
            continue;
        }
        let default = match key.default {
            Some("\"\"") => "none".to_owned(),
            Some(value) => format!("`{value}`"),
            None if key.is_optional => "none".to_owned(),
            None => "must be given".to_owned(),
        };
        let expected = key.accepts.expected();
        _ = writeln!(page, "| `{name}` | {expected} | {default} | {why} |");
    }
    for (title, why, keys, full) in inner {
        _ = writeln!(page, "\n## `{title}`\n\n{why}");
        print(page, keys, &format!("{full}."));
    }
}

#[test]
fn every_default_is_accepted_and_every_reason_fits_a_table() {
    fn check(keys: &[Key], prefix: &str) {
        for key in keys {
            let full = format!("{prefix}{}", key.name);
            assert!(key.why.ends_with('.') && !key.why.contains('|'), "{full}");
            if let Some(default) = key.default
                && !["[]", "\"\""].contains(&default)
            {
                let value = key.default_value();
                assert!(value.is_some_and(|it| key.accepts.takes(&it)), "{full}");
            }
            if let Some(keys) = key.accepts.keys() {
                check(keys, &format!("{full}."));
            }
        }
    }
    check(&keys(), "");
}
