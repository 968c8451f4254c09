//! Pieces of messages: foreign text, which a model, a server or a program wrote; names and counts.

use fab_program::invisible::is_invisible;
use std::fmt::Display;

/// Returns a text on one line, with control and formatting characters made visible, and cut after `most` characters.
///
/// `\u{1b}` in a model's answer would otherwise colour or clear the terminal, and a bidirectional mark reorder the line.
pub fn shown(text: &str, most: usize) -> String {
    let mut shown = String::new();
    for (index, letter) in text.trim().chars().enumerate() {
        if index == most {
            shown.push('…');
            break;
        }
        if letter.is_control() || is_invisible(letter) {
            shown.extend(letter.escape_default());
        } else {
            shown.push(letter);
        }
    }
    shown
}

/// Lists names in backticks.
pub fn quoted(names: impl IntoIterator<Item = impl Display>) -> String {
    let names = names.into_iter().map(|name| format!("`{name}`"));
    names.collect::<Vec<_>>().join(", ")
}

/// Formats a count with its noun, whose plural ends in `s`.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
#[path = "tests/wording.rs"]
mod tests;
