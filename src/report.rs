//! The result of a verb: one typed value, as text for people and as JSON for programs.
//!
//! The JSON is what the type's fields say (`derive(Serialize)`), so that the names stand in one place.

use crate::io::Io;
use serde::Serialize;

pub trait Report: Serialize {
    /// Returns the result as text; nothing is printed if it is empty.
    fn text(&self) -> String;
}

impl Io {
    /// Writes a verb's result to stdout: as one JSON document if `--json` was given, else as text.
    pub(crate) fn result(&self, json: bool, result: &impl Report) {
        self.either(json, result, || result.text());
    }

    /// Writes a document to stdout as JSON if `--json` was given, else the text that says the same.
    pub(crate) fn either(
        &self,
        json: bool,
        document: &impl Serialize,
        text: impl FnOnce() -> String,
    ) {
        if json {
            self.json(document);
            return;
        }
        let text = text();
        if !text.is_empty() {
            self.data(&text);
        }
    }
}
