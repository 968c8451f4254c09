//! Stdout for data, stderr for talk; a closed pipe is no error.

use std::io::{IsTerminal, Write};

/// Writes data and a line end to stdout.
pub fn data(text: &str) {
    // A reader that has seen enough (`| head`) closes the pipe; nobody is left to be told.
    let _ = writeln!(std::io::stdout().lock(), "{text}");
}

/// Writes a line of talk to stderr.
pub fn talk(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Writes one JSON document to stdout.
pub fn json(value: &serde_json::Value) {
    data(&serde_json::to_string_pretty(value).expect("a JSON value can be written"));
}

/// Returns whether talk may be coloured.
pub fn talk_color() -> compiler::diag::Color {
    color(std::io::stderr().is_terminal())
}

/// Returns whether data may be coloured.
pub fn data_color() -> compiler::diag::Color {
    color(std::io::stdout().is_terminal())
}

fn color(terminal: bool) -> compiler::diag::Color {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if terminal && !refused {
        compiler::diag::Color::Ansi
    } else {
        compiler::diag::Color::Plain
    }
}
