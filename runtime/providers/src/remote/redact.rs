//! Hides keys in everything that comes back from the network.
//!
//! In: every known key, and bytes or text. Out: the same with `[key]` in place of each key, including keys that are
//! percent-encoded, JSON-escaped, in base64, or in a mixture of such escapes. Keys shorter than eight characters are
//! not hidden, because ordinary words would vanish with them.

use super::Key;
use base64::Engine;
use base64::engine::general_purpose::{STANDARD_NO_PAD, URL_SAFE_NO_PAD};
use secrecy::{ExposeSecret, SecretBox};
use serde_json::Value;
use std::fmt;

/// The replacement for a key.
const HIDDEN: &[u8] = b"[key]";

/// The shortest key that is hidden, characters.
const SHORTEST: usize = 8;

/// The most backslashes before a letter that count as its escape; JSON nested five times writes 31.
///
/// Without a limit, each byte of a long run would count all the following ones.
const MOST_SLASHES: usize = 31;

/// Replaces known keys; its `Debug` form says only how many.
#[derive(Default)]
pub struct Redactor {
    /// Plain keys, longest first; any of their characters may appear escaped.
    plain: Vec<SecretBox<Vec<u8>>>,
    /// The fixed parts of each key's base64, for every offset within a group of three bytes.
    encoded: Vec<SecretBox<Vec<u8>>>,
}

impl Redactor {
    /// Makes one that hides the given keys.
    pub fn of<'k>(keys: impl IntoIterator<Item = &'k Key>) -> Redactor {
        let mut keys: Vec<&[u8]> = keys
            .into_iter()
            .map(|key| key.expose().as_bytes())
            .filter(|key| key.len() >= SHORTEST)
            .collect();
        // Longest first: a key that starts like a shorter one must not be hidden only in part.
        keys.sort_by_key(|key| std::cmp::Reverse(key.len()));
        let secret = |bytes: Vec<u8>| SecretBox::new(Box::new(bytes));
        Redactor {
            encoded: keys
                .iter()
                .flat_map(|key| encoded(key))
                .map(secret)
                .collect(),
            plain: keys.into_iter().map(|key| secret(key.to_vec())).collect(),
        }
    }

    /// Returns the bytes without any key.
    pub fn bytes(&self, bytes: &[u8]) -> Vec<u8> {
        let mut out = Vec::with_capacity(bytes.len());
        let mut at = 0;
        while at < bytes.len() {
            match self.length_at(&bytes[at..]) {
                Some(length) => {
                    out.extend_from_slice(HIDDEN);
                    at += length;
                }
                None => {
                    out.push(bytes[at]);
                    at += 1;
                }
            }
        }
        out
    }

    /// Returns the text without any key.
    pub fn text(&self, text: &str) -> String {
        // Keys are ASCII, so cuts fall on character boundaries.
        String::from_utf8_lossy(&self.bytes(text.as_bytes())).into_owned()
    }

    /// Returns a body without any key, in its bytes and in their meaning as JSON.
    ///
    /// An escape that JSON decodes, such as `\\u0025` for the `%` of another escape, hides a key from a check of the
    /// bytes alone.
    pub(super) fn body(&self, bytes: &[u8]) -> Vec<u8> {
        let bytes = self.bytes(bytes);
        if self.plain.is_empty() {
            return bytes;
        }
        if let Ok(mut value) = serde_json::from_slice::<Value>(&bytes)
            && self.hides_in(&mut value)
        {
            return value.to_string().into_bytes();
        }
        // If it is not JSON, the reader of the body reports that.
        bytes
    }

    /// Hides keys in every string; returns whether there were any.
    fn hides_in(&self, value: &mut Value) -> bool {
        match value {
            Value::String(text) => {
                let hidden = self.text(text);
                let found = hidden != *text;
                *text = hidden;
                found
            }
            Value::Array(items) => {
                let found = items.iter_mut().map(|item| self.hides_in(item));
                found.fold(false, |any, found| any | found)
            }
            Value::Object(fields) => {
                let mut any = false;
                let whole = std::mem::take(fields);
                for (name, mut field) in whole {
                    let hidden = self.text(&name);
                    any |= self.hides_in(&mut field) | (hidden != name);
                    fields.insert(hidden, field);
                }
                any
            }
            Value::Null | Value::Bool(_) | Value::Number(_) => false,
        }
    }

    /// Returns how many bytes at the beginning represent a key.
    fn length_at(&self, bytes: &[u8]) -> Option<usize> {
        let plain = self.plain.iter();
        let plain = plain.filter_map(|key| length_of_key(bytes, key.expose_secret()));
        let encoded = self.encoded.iter().filter_map(|stretch| {
            let stretch = stretch.expose_secret();
            bytes.starts_with(stretch).then_some(stretch.len())
        });
        plain.chain(encoded).max()
    }
}

impl fmt::Debug for Redactor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Redactor({} keys)", self.plain.len())
    }
}

/// Returns how many bytes at the beginning represent the whole key.
fn length_of_key(bytes: &[u8], key: &[u8]) -> Option<usize> {
    let mut at = 0;
    for wanted in key {
        at += length_of_letter(&bytes[at..], *wanted)?;
    }
    Some(at)
}

/// Returns how many bytes at the beginning represent one letter: itself, `%41`, `\u0041`, or `\/`.
fn length_of_letter(bytes: &[u8], wanted: u8) -> Option<usize> {
    if bytes.first() == Some(&wanted) {
        return Some(1);
    }
    let hex = |digits: Option<&[u8]>| -> Option<u8> {
        let text = std::str::from_utf8(digits?).ok()?;
        u8::from_str_radix(text, 16).ok()
    };
    if bytes.first() == Some(&b'%') && hex(bytes.get(1..3)) == Some(wanted) {
        return Some(3);
    }
    // JSON within JSON doubles its backslashes.
    let near = &bytes[..bytes.len().min(MOST_SLASHES)];
    let slashes = near.iter().take_while(|byte| **byte == b'\\').count();
    let rest = &bytes[slashes..];
    if slashes > 0 && rest.first() == Some(&wanted) {
        return Some(slashes + 1);
    }
    let escaped = slashes > 0 && rest.starts_with(b"u00") && hex(rest.get(3..5)) == Some(wanted);
    escaped.then_some(slashes + 5)
}

/// Returns the parts of the key's base64 that do not depend on neighbouring bytes, for the three offsets where it can
/// begin.
fn encoded(key: &[u8]) -> Vec<Vec<u8>> {
    let mut stretches = Vec::new();
    for before in 0..3usize {
        let mut bytes = vec![0; before];
        bytes.extend_from_slice(key);
        let whole = bytes.len() / 3 * 4;
        // The first group contains bits of the preceding bytes, unless the key starts it.
        let first = if before == 0 { 0 } else { 4 };
        for alphabet in [&STANDARD_NO_PAD, &URL_SAFE_NO_PAD] {
            let text = alphabet.encode(&bytes).into_bytes();
            stretches.push(text[first..whole].to_vec());
        }
    }
    stretches
}

#[cfg(test)]
#[path = "tests/redaction.rs"]
mod tests;
