//! Hides keys in everything that comes back from the network.
//!
//! In: every known key, and text or a body. Out: the same with `[key]` in place of each key. In JSON a key is found however
//! its letters are escaped. Keys shorter than eight characters are not hidden, because ordinary words would vanish with
//! them.

use super::Key;
use secrecy::{ExposeSecret, SecretString};
use serde_json::Value;
use std::fmt;

/// The replacement for a key.
const HIDDEN: &str = "[key]";

/// The shortest key that is hidden, characters.
const SHORTEST: usize = 8;

/// Replaces known keys; its `Debug` form says only how many.
#[derive(Default)]
pub struct Redactor {
    /// Longest first: a key that starts like a shorter one must not be hidden only in part.
    keys: Vec<SecretString>,
}

impl Redactor {
    /// Makes one that hides the given keys.
    pub fn of<'k>(keys: impl IntoIterator<Item = &'k Key>) -> Redactor {
        let keys = keys.into_iter().map(Key::expose);
        let mut keys: Vec<&str> = keys.filter(|key| key.len() >= SHORTEST).collect();
        keys.sort_by_key(|key| std::cmp::Reverse(key.len()));
        Redactor {
            keys: keys.into_iter().map(SecretString::from).collect(),
        }
    }

    /// Returns the text without any key.
    pub fn text(&self, text: &str) -> String {
        let hide = |text: String, key: &SecretString| text.replace(key.expose_secret(), HIDDEN);
        self.keys.iter().fold(text.to_owned(), hide)
    }

    /// Returns a body without any key. JSON without one stays as it is.
    pub(super) fn body(&self, bytes: &[u8]) -> Vec<u8> {
        let Ok(mut value) = serde_json::from_slice::<Value>(bytes) else {
            return self.text(&String::from_utf8_lossy(bytes)).into_bytes();
        };
        if self.hides_in(&mut value) {
            return value.to_string().into_bytes();
        }
        bytes.to_vec()
    }

    /// Hides keys in every string; returns whether there were any.
    fn hides_in(&self, value: &mut Value) -> bool {
        let mut any = false;
        match value {
            Value::String(text) => {
                let hidden = self.text(text);
                any = hidden != *text;
                *text = hidden;
            }
            Value::Array(items) => {
                for item in items {
                    any |= self.hides_in(item);
                }
            }
            Value::Object(fields) => {
                for (name, mut field) in std::mem::take(fields) {
                    let hidden = self.text(&name);
                    any |= self.hides_in(&mut field) | (hidden != name);
                    fields.insert(hidden, field);
                }
            }
            Value::Null | Value::Bool(_) | Value::Number(_) => {}
        }
        any
    }
}

impl fmt::Debug for Redactor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Redactor({} keys)", self.keys.len())
    }
}

#[cfg(test)]
#[path = "tests/redaction.rs"]
mod tests;
