//! Hides keys in everything that comes back from the network.
//!
//! In: every known key, and text or a body. Out: the same with `[key]` in place of each key. In any text, JSON or not,
//! a key is found as it is, and with any of its letters escaped as in JSON (`\/`, `\u0073`) or in a URL (`%2F`). It is
//! not found in base64, in escapes of HTML, escaped for a URL twice, or cut in pieces. Keys shorter than eight
//! characters are not hidden, because ordinary words would vanish with them.

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
        let hide = |text: String, key: &SecretString| without(&text, key.expose_secret());
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

/// Returns the text without a key.
fn without(text: &str, key: &str) -> String {
    let text = text.replace(key, HIDDEN);
    if !text.contains(['\\', '%']) {
        return text;
    }
    let mut hidden = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(first) = rest.chars().next() {
        let (shown, next) = match key.chars().try_fold(rest, after) {
            Some(next) => (HIDDEN, next),
            None => {
                // Of backslashes in a row only the first is tried, or many would take quadratic time.
                let n_backslashes = rest.len() - rest.trim_start_matches('\\').len();
                rest.split_at(n_backslashes.max(first.len_utf8()))
            }
        };
        hidden.push_str(shown);
        rest = next;
    }
    hidden
}

/// Returns what follows a letter at the beginning of a text, however it is escaped; `None`: another letter is there.
///
/// A letter may have several backslashes before it, as in JSON within JSON.
fn after(text: &str, letter: char) -> Option<&str> {
    let bare = match letter {
        // Of two backslashes, the second goes with the next letter.
        '\\' => text,
        _ => text.trim_start_matches('\\'),
    };
    let (sign, n_digits) = match bare.len() < text.len() {
        true => ('u', 4),
        false => ('%', 2),
    };
    let code = bare.strip_prefix(sign);
    let code = code.and_then(|code| code.split_at_checked(n_digits));
    let is_letter = |digits: &str| u32::from_str_radix(digits, 16) == Ok(u32::from(letter));
    match code {
        Some((digits, rest)) if is_letter(digits) => Some(rest),
        _ => bare.strip_prefix(letter),
    }
}

#[cfg(test)]
#[path = "tests/redaction.rs"]
mod tests;
