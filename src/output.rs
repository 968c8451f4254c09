//! Stdout for data, stderr for talk; a closed pipe is no error.

use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::OnceLock;

/// Why data could not be written, where that happened.
static LOST: OnceLock<String> = OnceLock::new();

/// Returns why some data could not be written; a reader that closed the pipe is no such reason.
pub fn lost() -> Option<&'static str> {
    LOST.get().map(String::as_str)
}

/// Writes data and a line end to stdout.
pub fn data(text: &str) {
    // A reader that has seen enough (`| head`) closes the pipe; nobody is left to be told.
    let mut stdout = std::io::stdout().lock();
    if let Err(error) = writeln!(stdout, "{text}").and_then(|()| stdout.flush())
        && error.kind() != ErrorKind::BrokenPipe
    {
        LOST.get_or_init(|| error.to_string());
    }
}

/// Writes a line of talk to stderr.
pub fn talk(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Shows how far a long job is, in one line of a terminal that the next call replaces; elsewhere nothing.
///
/// An empty text takes the line away.
#[cfg(feature = "runtime")]
pub fn progress(text: &str) {
    let mut stderr = std::io::stderr().lock();
    if stderr.is_terminal() {
        // Carriage return, text, and "erase to the end of the line".
        let _ = write!(stderr, "\r{text}\x1b[K").and_then(|()| stderr.flush());
    }
}

/// Writes one JSON document to stdout.
pub fn json(value: &serde_json::Value) {
    data(&serde_json::to_string_pretty(value).expect("a JSON value can be written"));
}

/// Returns whether talk may be coloured.
pub fn talk_color() -> fab_compiler::diag::Color {
    color(std::io::stderr().is_terminal())
}

/// Returns whether data may be coloured.
pub fn data_color() -> fab_compiler::diag::Color {
    color(std::io::stdout().is_terminal())
}

fn color(terminal: bool) -> fab_compiler::diag::Color {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if terminal && !refused {
        fab_compiler::diag::Color::Ansi
    } else {
        fab_compiler::diag::Color::Plain
    }
}
