//! API keys of providers: found by name, and never shown.
//!
//! In: a lookup of names (the command passes the environment's), a TOML file that only its owner can read. Out: a
//! [`Key`], whose value is exposed only for a request's header; or just the names in that file.
//! [`Redactor`](super::Redactor) hides keys in replies.

use crate::catalogue::is_key_name;
use fab_base::files::{self, line_of};
use secrecy::{ExposeSecret, SecretString};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use toml::{Spanned, Value};

/// The longest key file accepted, bytes.
const MAX_FILE_BYTES: u64 = 64 * 1024;

/// The longest key, bytes; those of current providers have fewer than 300.
const MAX_KEY_BYTES: usize = 8 * 1024;

/// A provider's key; its `Debug` form is its name.
#[derive(Clone)]
pub struct Key {
    name: String,
    secret: SecretString,
}

/// Why a key cannot be used; no message repeats any part of a key.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KeyError {
    /// It cannot be sent in a request.
    #[error("the value of `{name}` is not a valid key: {why}")]
    Malformed {
        /// Name of the variable or the entry.
        name: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// The file cannot be read.
    #[error("cannot read the keys in `{path}`: {why}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        why: String,
    },
    /// Others can read the file.
    #[error(
        "`{path}` holds keys, and others can read it (mode {mode:03o}); make it yours alone: chmod 600 '{path}'"
    )]
    Open {
        /// The file.
        path: PathBuf,
        /// Its permission bits.
        mode: u32,
    },
    /// The file is not a list of keys.
    #[error("line {line} of `{path}` is not of the form `NAME = \"KEY\"`")]
    NotAList {
        /// The file.
        path: PathBuf,
        /// The first line that is wrong, from 1.
        line: usize,
    },
}

impl Key {
    /// Makes a key from the value of a variable or entry, without surrounding white space.
    ///
    /// Fails if it is empty, too long, or has characters that a header cannot carry.
    pub fn new(name: &str, value: &str) -> Result<Key, KeyError> {
        let value = value.trim();
        let why = if value.is_empty() {
            Some("it is empty")
        } else if value.len() > MAX_KEY_BYTES {
            Some("it is longer than 8192 bytes")
        } else if !value.bytes().all(|byte| byte.is_ascii_graphic()) {
            Some("it has blanks, control characters or letters outside of ASCII in it")
        } else {
            None
        };
        match why {
            Some(why) => Err(KeyError::Malformed {
                name: name.to_owned(),
                why,
            }),
            None => Ok(Key {
                name: name.to_owned(),
                secret: SecretString::from(value),
            }),
        }
    }

    /// Finds the first of `names` that is set: each by `lookup`, then each in the file; `None` if there is none.
    ///
    /// An empty variable counts as not set. Fails if the value found cannot be used.
    pub fn find(
        names: &[&str],
        lookup: &dyn Fn(&str) -> Option<String>,
        file: Option<&Path>,
    ) -> Result<Option<Key>, KeyError> {
        for name in names {
            if let Some(value) = lookup(name).filter(|value| !value.trim().is_empty()) {
                return Key::new(name, &value).map(Some);
            }
        }
        let Some(path) = file else { return Ok(None) };
        for name in names {
            if let Some(key) = Key::from_file(path, name)? {
                return Ok(Some(key));
            }
        }
        Ok(None)
    }

    /// Reads the key `name` from a TOML file of lines `NAME = "KEY"`; `None` if it is not there.
    ///
    /// Fails if the file cannot be read, is not such a list, or, on Unix, can be read by others than its owner.
    pub fn from_file(path: &Path, name: &str) -> Result<Option<Key>, KeyError> {
        let entries = entries(path)?;
        let found = entries.get(name).map(|value| Key::new(name, value));
        found.transpose()
    }

    /// Returns the names in such a file, in alphabetical order, without checking their keys.
    ///
    /// Fails as [`Key::from_file`] does.
    pub fn names_in(path: &Path) -> Result<Vec<String>, KeyError> {
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

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Key({})", self.name)
    }
}

/// Reads a key file.
fn entries(path: &Path) -> Result<BTreeMap<String, String>, KeyError> {
    refuse_open_file(path)?;
    let text = files::read_text(path, MAX_FILE_BYTES).map_err(|why| KeyError::Unreadable {
        path: path.to_owned(),
        why,
    })?;
    let wrong_at = |start: usize| KeyError::NotAList {
        path: path.to_owned(),
        line: line_of(&text, start),
    };
    // The parser's own message quotes the line, and with it the key.
    let table: BTreeMap<Spanned<String>, Value> = toml::from_str(&text)
        .map_err(|error| wrong_at(error.span().map_or(0, |span| span.start)))?;
    let mut entries = BTreeMap::new();
    let mut wrong: Option<usize> = None;
    for (name, value) in table {
        let start = name.span().start;
        match value {
            // In a reversed line the key is in the place of its name.
            Value::String(value) if is_key_name(name.get_ref()) => {
                entries.insert(name.into_inner(), value);
            }
            _ => wrong = Some(wrong.map_or(start, |other| other.min(start))),
        }
    }
    wrong.map_or(Ok(entries), |start| Err(wrong_at(start)))
}

#[cfg(unix)]
fn refuse_open_file(path: &Path) -> Result<(), KeyError> {
    use std::os::unix::fs::PermissionsExt;
    let information = std::fs::metadata(path).map_err(|error| KeyError::Unreadable {
        path: path.to_owned(),
        why: error.to_string(),
    })?;
    let mode = information.permissions().mode() & 0o777;
    if information.is_file() && mode & 0o077 != 0 {
        return Err(KeyError::Open {
            path: path.to_owned(),
            mode,
        });
    }
    Ok(())
}

#[cfg(not(unix))]
fn refuse_open_file(_: &Path) -> Result<(), KeyError> {
    Ok(())
}

#[cfg(test)]
#[path = "tests/keys.rs"]
mod tests;
