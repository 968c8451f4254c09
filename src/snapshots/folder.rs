//! A folder of snapshots on disk.
//!
//! In: its path. Out: the names and contents of its snapshots. Opening it first finishes an interrupted change; without
//! one it writes nothing, so that read-only folders can be read. Other files in the folder are left alone.

use super::disk::{Disk, System};
use super::format::{self, Contents, MAX_PICTURE_BYTES, MAX_TEXT_BYTES, Snapshot};
use super::journal::{self, Lock};
use super::name::{Name, Side};
use super::{SnapshotError, change::Operation};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// The most files that are read.
const MAX_FILES: usize = 200_000;

/// A folder of snapshots.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    accepted: BTreeSet<Name>,
    pending: BTreeSet<Name>,
}

impl Folder {
    /// Opens a folder; one that does not exist is empty.
    ///
    /// Finishes an interrupted change first: completes it if its journal was written, otherwise discards it.
    pub fn open(path: impl Into<PathBuf>) -> Result<Folder, SnapshotError> {
        let path = path.into();
        if journal::is_interrupted(&path) {
            let _lock = Lock::take(&path)?;
            journal::recover(&System, &path)?;
        }
        let mut folder = Folder {
            path,
            accepted: BTreeSet::new(),
            pending: BTreeSet::new(),
        };
        folder.list()?;
        Ok(folder)
    }

    /// Returns the names of all snapshots, accepted or pending, in order.
    pub fn names(&self) -> impl Iterator<Item = &Name> {
        self.accepted.union(&self.pending)
    }

    /// Returns the names of all accepted snapshots, in order.
    pub fn accepted_names(&self) -> impl Iterator<Item = &Name> {
        self.accepted.iter()
    }

    /// Returns the names of all pending snapshots, in order.
    pub fn pending_names(&self) -> impl Iterator<Item = &Name> {
        self.pending.iter()
    }

    /// Reads an accepted snapshot; `None` if there is none.
    pub fn accepted(&self, name: &Name) -> Result<Option<Snapshot>, SnapshotError> {
        self.read(name, Side::Accepted)
    }

    /// Reads a pending snapshot; `None` if there is none.
    pub fn pending(&self, name: &Name) -> Result<Option<Snapshot>, SnapshotError> {
        self.read(name, Side::Pending)
    }

    /// Returns the path of an accepted snapshot, whether or not it exists.
    pub fn accepted_path(&self, name: &Name) -> PathBuf {
        self.path.join(name.file(Side::Accepted))
    }

    /// Returns the path of a pending snapshot, whether or not it exists.
    pub fn pending_path(&self, name: &Name) -> PathBuf {
        self.path.join(name.file(Side::Pending))
    }

    /// Applies all of a change or nothing, even if the process is stopped; waits a while for another process.
    ///
    /// Fails and changes nothing if one operation is impossible: see [`Operation`]. Creates the folder if it is
    /// missing.
    pub fn apply(&mut self, operations: &[Operation]) -> Result<(), SnapshotError> {
        self.apply_on(&System, operations)
    }

    pub(super) fn apply_on(
        &mut self,
        disk: &dyn Disk,
        operations: &[Operation],
    ) -> Result<(), SnapshotError> {
        if operations.is_empty() {
            return Ok(());
        }
        disk.make_folder(&self.path)
            .map_err(|error| SnapshotError::unwritable(&self.path, &error))?;
        let _lock = Lock::take(&self.path)?;
        journal::recover(disk, &self.path)?;
        let (new_files, steps) = super::change::steps(self, operations)?;
        journal::commit(disk, &self.path, &new_files, &steps)?;
        self.list()
    }

    fn list(&mut self) -> Result<(), SnapshotError> {
        let unreadable = |error: &std::io::Error| SnapshotError::unreadable(&self.path, error);
        self.accepted.clear();
        self.pending.clear();
        let entries = match fs::read_dir(&self.path) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(unreadable(&error)),
        };
        for (count, entry) in entries.enumerate() {
            if count >= MAX_FILES {
                return Err(SnapshotError::TooMany {
                    path: self.path.clone(),
                    most: MAX_FILES,
                });
            }
            let file = entry.map_err(|error| unreadable(&error))?.file_name();
            match file.to_str().and_then(Name::of_file) {
                Some((name, Side::Accepted)) => self.accepted.insert(name),
                Some((name, Side::Pending)) => self.pending.insert(name),
                None => false,
            };
        }
        Ok(())
    }

    pub(super) fn read(&self, name: &Name, side: Side) -> Result<Option<Snapshot>, SnapshotError> {
        let path = self.path.join(name.file(side));
        let Some(bytes) = read_bounded(&path, MAX_TEXT_BYTES)? else {
            return Ok(None);
        };
        let parsed = format::parse(&bytes).map_err(|why| SnapshotError::Format {
            path: path.clone(),
            why,
        })?;
        let contents = match parsed.text {
            Some(text) => Contents::Text(text),
            None => {
                let picture = self.path.join(name.picture(side));
                match read_bounded(&picture, MAX_PICTURE_BYTES)? {
                    Some(bytes) => Contents::Picture(bytes),
                    None => return Err(SnapshotError::PictureMissing { path, picture }),
                }
            }
        };
        Ok(Some(Snapshot {
            metadata: parsed.metadata,
            contents,
        }))
    }
}

/// Reads a file; `None` if there is none. Reads only plain files: a pipe may never end, and a link may lead anywhere.
fn read_bounded(path: &Path, most: u64) -> Result<Option<Vec<u8>>, SnapshotError> {
    let unreadable = |error: std::io::Error| SnapshotError::unreadable(path, &error);
    let found = match fs::symlink_metadata(path) {
        Ok(found) => found,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(unreadable(error)),
    };
    if !found.is_file() {
        let why = match found.is_symlink() {
            true => "it is a link, and a snapshot is a file of its own",
            false => "it is not a file",
        };
        return Err(SnapshotError::Format {
            path: path.to_owned(),
            why: why.to_owned(),
        });
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(most + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > most {
        return Err(SnapshotError::TooLarge {
            path: path.to_owned(),
            most,
        });
    }
    Ok(Some(bytes))
}
