//! A folder of snapshots on disk.
//!
//! In: its path. Out: the names and contents of its snapshots, and changed files. Other files are left alone.

use super::Name;
use super::format::{self, Contents, Snapshot};
use crate::exit::Failure;
use fab_base::files;
use std::collections::BTreeSet;
use std::fmt::Display;
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
    pub fn open(path: impl Into<PathBuf>) -> Result<Folder, Failure> {
        let path = path.into();
        let files = fs::read_dir(&path).and_then(|entries| {
            let names = entries.map(|entry| entry.map(|entry| entry.file_name()));
            names.collect::<io::Result<Vec<_>>>()
        });
        let files = match files {
            Ok(files) => files,
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(unreadable(&path, error)),
        };
        let on = |side: Side| {
            let files = files.iter().map(|file| file.to_string_lossy());
            let names = files.map(|file| file.strip_suffix(side.extension()).map(Name::from));
            names.flatten().collect()
        };
        Ok(Folder {
            accepted: on(Side::Accepted),
            pending: on(Side::Pending),
            path,
        })
    }

    /// Returns the path of a snapshot, whether or not it exists.
    pub fn file(&self, name: &str, side: Side) -> PathBuf {
        self.path.join(format!("{name}{}", side.extension()))
    }

    /// Reads a snapshot; `None` if there is none.
    pub fn read(&self, name: &str, side: Side) -> Result<Option<Snapshot>, Failure> {
        let path = self.file(name, side);
        if !path.exists() {
            return Ok(None);
        }
        let text = files::read_text(&path, MAX_TEXT_BYTES).map_err(|why| unreadable(&path, why))?;
        let (metadata, text) = format::parse(&text).map_err(|why| {
            let path = path.display();
            Failure::environment(format!(
                "`{path}` is not a snapshot that can be read: {why}"
            ))
        })?;
        let contents = match text {
            Some(text) => Contents::Text(text),
            None => {
                let path = picture_of(&path);
                let picture = files::read(&path, MAX_PICTURE_BYTES);
                Contents::Picture(picture.map_err(|why| unreadable(&path, why))?)
            }
        };
        Ok(Some(Snapshot { metadata, contents }))
    }

    /// Makes a snapshot pending, in place of one that is pending under its name.
    pub fn propose(&self, name: &str, snapshot: &Snapshot) -> Result<(), Failure> {
        let path = self.file(name, Side::Pending);
        let file = format::write(snapshot).map_err(Failure::environment)?;
        let write = || {
            fs::create_dir_all(&self.path)?;
            let picture = picture_of(&path);
            // A reader never finds a file without its picture.
            match &snapshot.contents {
                Contents::Picture(bytes) => {
                    replace(&picture, bytes)?;
                    replace(&path, file.as_bytes())
                }
                Contents::Text(_) => {
                    replace(&path, file.as_bytes())?;
                    remove_file(&picture)
                }
            }
        };
        write().map_err(|error| Failure::unwritable(&path, error))
    }

    /// Accepts a pending snapshot; fails if it is no longer the one that the user looked at.
    pub fn accept(&self, name: &str, seen: &Snapshot) -> Result<(), Failure> {
        let [from, to] = [Side::Pending, Side::Accepted].map(|side| self.file(name, side));
        if self.read(name, Side::Pending)?.as_ref() != Some(seen) {
            return Err(Failure::environment(format!(
                "`{}` has changed since it was shown, and was not accepted; look at it again",
                from.display()
            )));
        }
        let moved = match seen.contents {
            Contents::Text(_) => {
                fs::rename(&from, &to).and_then(|()| remove_file(&picture_of(&to)))
            }
            Contents::Picture(_) => {
                fs::rename(picture_of(&from), picture_of(&to)).and_then(|()| fs::rename(&from, &to))
            }
        };
        moved.map_err(|error| Failure::unwritable(&to, error))
    }

    pub fn remove(&self, name: &str, side: Side) -> Result<(), Failure> {
        let path = self.file(name, side);
        let removed = remove_file(&path).and_then(|()| remove_file(&picture_of(&path)));
        removed.map_err(|error| Failure::unwritable(&path, error))
    }
}

/// Returns the path of the picture that belongs to a snapshot file.
pub fn picture_of(file: &Path) -> PathBuf {
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

fn unreadable(path: &Path, why: impl Display) -> Failure {
    Failure::environment(format!("cannot read `{}`: {why}", path.display()))
}
