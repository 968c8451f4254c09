//! The result of a verb: one typed value, as text for people and as JSON for programs.
//!
//! The JSON is what the type's fields say (`derive(Serialize)`), so that the names stand in one place.

use crate::io::Io;
use serde::Serialize;

/// A verb's result.
pub trait Report: Serialize {
    /// Returns the result as text; nothing is printed if it is empty.
    fn text(&self) -> String;
}

impl Io {
    /// Writes a verb's result to stdout: as one JSON document if `--json` was given, else as text.
    pub(crate) fn result(&self, json: bool, result: &impl Report) {
        if json {
            self.json(result);
            return;
        }
        let text = result.text();
        if !text.is_empty() {
            self.data(&text);
        }
    }
}
