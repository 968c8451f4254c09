//! A folder of snapshots on disk.
//!
//! In: its path. Out: the names and contents of its snapshots, and changed files. Other files are left alone.

use super::format::{self, Contents, Snapshot};
use super::{Name, SnapshotError};
use fab_base::files;
use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The longest snapshot file without its picture, bytes.
const MAX_TEXT_BYTES: u64 = 4 << 20;
/// The longest picture, bytes.
const MAX_PICTURE_BYTES: u64 = 32 << 20;

/// Whether a snapshot is accepted or pending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The user looked at it and accepted it.
    Accepted,
    /// It is proposed.
    Pending,
}

impl Side {
    fn extension(self) -> &'static str {
        match self {
            Side::Accepted => ".snap",
            Side::Pending => ".snap.new",
        }
    }
}

/// A folder of snapshots.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// The names of the snapshots that were accepted when it was opened.
    pub accepted: BTreeSet<Name>,
    /// The names of those that were pending.
    pub pending: BTreeSet<Name>,
}

impl Folder {
    /// Lists the snapshots of a folder; one that does not exist is empty.
    pub fn open(path: impl Into<PathBuf>) -> Result<Folder, SnapshotError> {
        let mut folder = Folder {
            path: path.into(),
            accepted: BTreeSet::new(),
            pending: BTreeSet::new(),
        };
        let files = fs::read_dir(&folder.path).and_then(|entries| {
            let names = entries.map(|entry| entry.map(|entry| entry.file_name()));
            names.collect::<io::Result<Vec<_>>>()
        });
        match files {
            Ok(names) => {
                for name in names {
                    folder.add(&name.to_string_lossy());
                }
                Ok(folder)
            }
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(folder),
            Err(error) => Err(SnapshotError::Unreadable {
                path: folder.path,
                why: error.to_string(),
            }),
        }
    }

    fn add(&mut self, file: &str) {
        let name = |name: &str| Name(name.to_owned());
        if let Some(accepted) = file.strip_suffix(Side::Accepted.extension()) {
            self.accepted.insert(name(accepted));
        } else if let Some(pending) = file.strip_suffix(Side::Pending.extension()) {
            self.pending.insert(name(pending));
        }
    }

    /// Returns the path of a snapshot, whether or not it exists.
    pub fn file(&self, name: &Name, side: Side) -> PathBuf {
        self.path.join(format!("{name}{}", side.extension()))
    }

    /// Reads a snapshot; `None` if there is none.
    pub fn read(&self, name: &Name, side: Side) -> Result<Option<Snapshot>, SnapshotError> {
        let path = self.file(name, side);
        if !path.exists() {
            return Ok(None);
        }
        let read = |path: &Path, most| {
            files::read(path, most).map_err(|why| SnapshotError::Unreadable {
                path: path.to_owned(),
                why,
            })
        };
        let bytes = read(&path, MAX_TEXT_BYTES)?;
        let (metadata, text) = format::parse(&bytes).map_err(|why| SnapshotError::Format {
            path: path.clone(),
            why,
        })?;
        let contents = match text {
            Some(text) => Contents::Text(text),
            None => Contents::Picture(read(&picture_of(&path), MAX_PICTURE_BYTES)?),
        };
        Ok(Some(Snapshot { metadata, contents }))
    }

    /// Makes a snapshot pending, in place of one that is pending under its name.
    pub fn propose(&self, name: &Name, snapshot: &Snapshot) -> Result<(), SnapshotError> {
        let path = self.file(name, Side::Pending);
        let file = format::write(snapshot).map_err(|why| SnapshotError::Format {
            path: path.clone(),
            why,
        })?;
        let write = || {
            fs::create_dir_all(&self.path)?;
            // A reader never finds a file without its picture.
            if let Contents::Picture(bytes) = &snapshot.contents {
                replace(&picture_of(&path), bytes)?;
            }
            replace(&path, file.as_bytes())?;
            match &snapshot.contents {
                Contents::Text(_) => remove_file(&picture_of(&path)),
                Contents::Picture(_) => Ok(()),
            }
        };
        or_unwritable(&path, write())
    }

    /// Accepts a pending snapshot; fails if it is no longer the one that the user looked at.
    pub fn accept(&self, name: &Name, seen: &Snapshot) -> Result<(), SnapshotError> {
        let [from, to] = [Side::Pending, Side::Accepted].map(|side| self.file(name, side));
        if self.read(name, Side::Pending)?.as_ref() != Some(seen) {
            return Err(SnapshotError::Changed { path: from });
        }
        let moved = match seen.contents {
            Contents::Text(_) => {
                fs::rename(&from, &to).and_then(|()| remove_file(&picture_of(&to)))
            }
            Contents::Picture(_) => {
                fs::rename(picture_of(&from), picture_of(&to)).and_then(|()| fs::rename(&from, &to))
            }
        };
        or_unwritable(&to, moved)
    }

    /// Removes a snapshot, if there is one.
    pub fn remove(&self, name: &Name, side: Side) -> Result<(), SnapshotError> {
        let path = self.file(name, side);
        let removed = remove_file(&path).and_then(|()| remove_file(&picture_of(&path)));
        or_unwritable(&path, removed)
    }
}

/// Returns the path of the picture that belongs to a snapshot file.
fn picture_of(file: &Path) -> PathBuf {
    file.with_added_extension(format::PICTURE)
}

/// Writes a file under another name and renames it. Nothing is synced: what is pending can be proposed again.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let part = path.with_added_extension("part");
    fs::write(&part, bytes)?;
    fs::rename(&part, path)
}

fn remove_file(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}

fn or_unwritable(path: &Path, changed: io::Result<()>) -> Result<(), SnapshotError> {
    changed.map_err(|error| SnapshotError::Unwritable {
        path: path.to_owned(),
        error,
    })
}
