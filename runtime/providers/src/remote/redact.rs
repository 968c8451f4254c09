//! Hides keys in everything that comes back from the network.
//!
//! In: every known key, and text or a body. Out: the same with `[key]` in place of each key. A key is found as it is,
//! not in base64, cut in pieces, or with letters escaped: providers' keys consist of letters, digits, `-`, `_` and `.`,
//! which neither JSON nor URLs escape. Keys shorter than eight characters are not hidden, because ordinary words would
//! vanish with them.

use super::Key;
use secrecy::{ExposeSecret, SecretString};

/// The replacement for a key.
const HIDDEN: &str = "[key]";

/// The shortest key that is hidden, characters.
const SHORTEST: usize = 8;

/// Replaces known keys; its `Debug` form holds none.
#[derive(Debug)]
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

    /// Returns a body without any key. One without a key stays as it is, even if it is not UTF-8.
    pub(super) fn body(&self, bytes: &[u8]) -> Vec<u8> {
        let text = String::from_utf8_lossy(bytes);
        let hidden = self.text(&text);
        if hidden == text {
            return bytes.to_vec();
        }
        hidden.into_bytes()
    }
}

#[cfg(test)]
#[path = "tests/redaction.rs"]
mod tests;
