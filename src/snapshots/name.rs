//! Names of snapshots, which are also their file names without the extension.

use super::SnapshotError;
use serde::Serialize;
use std::fmt;

/// Extension of an accepted snapshot's file.
const ACCEPTED: &str = ".snap";
/// Extension of a pending snapshot's file.
const PENDING: &str = ".snap.new";
/// The longest name, bytes; most file systems allow 255 including the extension.
const MAX_NAME_BYTES: usize = 200;

/// The name of a snapshot, such as `double_straight.describe@start`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(transparent)]
pub struct Name(String);

impl Name {
    /// Checks a name: it must be a valid file name on any system, without blanks or path parts, at most 200 bytes.
    pub fn new(name: impl Into<String>) -> Result<Name, SnapshotError> {
        let name = name.into();
        match fault(&name) {
            None => Ok(Name(name)),
            Some(why) => Err(SnapshotError::Name { name, why }),
        }
    }

    /// Returns the snapshot that a file name stands for, if any: its name, and whether it is accepted or pending.
    pub(super) fn of_file(file: &str) -> Option<(Name, Side)> {
        let (name, side) = match file.strip_suffix(PENDING) {
            Some(name) => (name, Side::Pending),
            None => (file.strip_suffix(ACCEPTED)?, Side::Accepted),
        };
        Some((Name::new(name).ok()?, side))
    }

    /// Returns the name as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Returns the file name of the accepted or pending snapshot.
    pub(super) fn file(&self, side: Side) -> String {
        match side {
            Side::Accepted => format!("{}{ACCEPTED}", self.0),
            Side::Pending => format!("{}{PENDING}", self.0),
        }
    }

    /// Returns the file name of the accepted or pending picture.
    pub(super) fn picture(&self, side: Side) -> String {
        format!("{}.{}", self.file(side), super::format::PICTURE)
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Whether a file is accepted or pending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The user looked at it and accepted it.
    Accepted,
    /// It is proposed.
    Pending,
}

fn fault(name: &str) -> Option<&'static str> {
    let is_unfit = |letter: char| {
        letter.is_whitespace() || letter.is_control() || "/\\:*?\"<>|".contains(letter)
    };
    if name.is_empty() {
        Some("it is empty")
    } else if name.len() > MAX_NAME_BYTES {
        Some("it has more than 200 bytes")
    } else if name.starts_with('.') || name.ends_with('.') {
        Some("it begins or ends with a full stop")
    } else if name.contains(ACCEPTED) {
        Some("it contains `.snap`, which ends a name")
    } else if name.contains(is_unfit) {
        Some("it contains a blank, or a letter that file names may not have everywhere")
    } else {
        None
    }
}
