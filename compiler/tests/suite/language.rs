//! The tables and lists of the language reference are complete; the book's own test compiles its examples.

use crate::common;
use crate::reference::tables;
use std::fs;

fn reference() -> String {
    fs::read_to_string(common::workspace().join("docs/language.md")).unwrap()
}

const BEGIN: &str = "<!-- table: ";
const END: &str = "<!-- end -->";

/// Replaces the tables of a page; other text is left alone.
///
/// Returns `None` if a table's end marker is missing.
fn refreshed(page: &str) -> Option<String> {
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

/// The tables between markers are the ones that the compiler's own tables give; `FABC_WRITE_DOCS=1` writes them.
#[test]
fn the_tables_of_the_reference_are_those_of_the_compiler() {
    let text = reference();
    let refreshed = refreshed(&text).expect("each table has its end");
    if std::env::var_os("FABC_WRITE_DOCS").is_some() {
        fs::write(common::workspace().join("docs/language.md"), refreshed).unwrap();
        return;
    }
    for (name, _) in tables() {
        assert!(
            text.contains(&format!("<!-- table: {name} -->")),
            "`{name}` stands nowhere"
        );
    }
    assert!(
        text == refreshed,
        "write them: FABC_WRITE_DOCS=1 cargo test -p fab-compiler --test suite language::"
    );
}

#[test]
fn limits_are_as_stated() {
    let text = reference();
    for row in [
        format!("| a file | {} KiB |", fab_grammar::MAX_BYTES >> 10),
        format!("| files in one compilation | {} |", fab_compiler::MAX_FILES),
        format!(
            "| letters of a word outside of texts | {} |",
            fab_grammar::MAX_WORD_BYTES
        ),
        format!(
            "| tasks below a task | {} |",
            fab_compiler::MAX_EXTENDS_DEPTH
        ),
        format!(
            "| open brackets and braces | {} |",
            fab_grammar::MAX_NESTING
        ),
    ] {
        assert!(text.contains(&row), "{row}");
    }
}
