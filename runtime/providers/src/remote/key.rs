//! API keys of providers: found by name, and never shown.
//!
//! In: a lookup of names (the command passes the environment's), a TOML file that only its owner can read. Out: a
//! [`Key`], whose value is exposed only for a request's header; or just the names in that file.
//! [`Redactor`](super::Redactor) hides keys in replies.

use crate::catalogue::is_key_name;
use fab_base::files::{self, line_of};
use secrecy::{ExposeSecret, SecretString};
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;

/// The longest key file accepted, bytes.
const MAX_FILE_BYTES: u64 = 64 * 1024;

/// A provider's key; its `Debug` form has its name alone.
#[derive(Clone, Debug)]
pub struct Key {
    name: String,
    secret: SecretString,
}

impl Key {
    /// Makes a key from the value of a variable or entry, without surrounding white space.
    ///
    /// Fails if it is empty, or has characters that a header cannot carry. No message repeats any part of a key.
    pub fn new(name: &str, value: &str) -> Result<Key, String> {
        let value = value.trim();
        if value.is_empty() || !value.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err(format!(
                "the value of `{name}` is not a valid key: it is empty, or has blanks, control characters or letters outside of ASCII in it"
            ));
        }
        Ok(Key {
            name: name.to_owned(),
            secret: SecretString::from(value),
        })
    }

    /// Finds the first of `names` that is set: each by `lookup`, then each in the file; `None` if there is none.
    ///
    /// An empty variable counts as not set. Fails if the value found cannot be used, or the file cannot be read, is not a list
    /// of lines `NAME = "KEY"`, or, on Unix, can be read by others than its owner.
    pub fn find(
        names: &[impl AsRef<str>],
        lookup: &dyn Fn(&str) -> Option<String>,
        file: Option<&Path>,
    ) -> Result<Option<Key>, String> {
        let names = || names.iter().map(AsRef::as_ref);
        for name in names() {
            if let Some(value) = lookup(name).filter(|value| !value.trim().is_empty()) {
                return Key::new(name, &value).map(Some);
            }
        }
        let Some(path) = file else { return Ok(None) };
        let entries = entries(path)?;
        let found = names().find_map(|name| Some((name, entries.get(name)?)));
        found.map(|(name, value)| Key::new(name, value)).transpose()
    }

    /// Returns the names in such a file, in alphabetical order, without checking their keys.
    ///
    /// Fails as [`Key::find`] does.
    pub fn names_in(path: &Path) -> Result<Vec<String>, String> {
        Ok(entries(path)?.into_keys().collect())
    }

    /// Returns the name under which it was found, e.g. `OPENAI_API_KEY`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the key itself, for a header and for redaction.
    pub(super) fn expose(&self) -> &str {
        self.secret.expose_secret()
    }
}

/// Reads a key file.
fn entries(path: &Path) -> Result<BTreeMap<String, String>, String> {
    let name = path.display();
    let unreadable = |why: String| format!("cannot read the keys in `{name}`: {why}");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let information = std::fs::metadata(path).map_err(|error| unreadable(error.to_string()))?;
        let mode = information.permissions().mode() & 0o777;
        if information.is_file() && mode & 0o077 != 0 {
            return Err(format!(
                "`{name}` holds keys, and others can read it (mode {mode:03o}); make it yours alone: chmod 600 '{name}'"
            ));
        }
    }
    let text = files::read_text(path, MAX_FILE_BYTES).map_err(unreadable)?;
    let wrong_at = |start| {
        let line = line_of(&text, start);
        format!("line {line} of `{name}` is not of the form `NAME = \"KEY\"`")
    };
    // The parser's own message quotes the line, and with it the key.
    let table: BTreeMap<Spanned<String>, String> = toml::from_str(&text)
        .map_err(|error| wrong_at(error.span().map_or(0, |span| span.start)))?;
    // In a reversed line the key is in the place of its name.
    let entries = table.into_iter().map(|(name, value)| {
        if is_key_name(name.get_ref()) {
            Ok((name.into_inner(), value))
        } else {
            Err(wrong_at(name.span().start))
        }
    });
    entries.collect()
}

#[cfg(test)]
#[path = "tests/keys.rs"]
mod tests;
