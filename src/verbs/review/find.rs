//! Finds pending snapshots, below folders or of files.
//!
//! In: the places named on the command line. Out: the snapshot folders, and each pending snapshot with the accepted
//! one. Snapshots that other tools wrote into such folders are counted and left alone. For our own, an unreadable
//! pending snapshot is an error; an unreadable accepted one counts as absent, since the pending one was made without
//! it.

use crate::exit::Failure;
use crate::snapshots::{Contents, FOLDER, Folder, Info, Name, Snapshot, SnapshotError};
use std::collections::BTreeSet;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Folders with generated or downloaded files.
const SKIPPED: [&str; 3] = ["target", "node_modules", "runs"];
/// How many levels below a named folder are searched, and the most folders that are.
const MAX_DEPTH: usize = 24;
const MAX_FOLDERS: usize = 100_000;
/// Precedes the scene in every name that `fabc` gives.
const SCENE: char = '@';
/// How much of an unreadable file is searched for a merge conflict, bytes.
const MAX_LOOKED_THROUGH_BYTES: u64 = 4 << 20;

/// Everything to review.
pub struct ReviewItems {
    /// The snapshot folders with anything to review.
    pub folders: Vec<Folder>,
    /// The pending snapshots, by folder and name.
    pub pending: Vec<Pending>,
    /// How many pending snapshots were not written by `fabc`.
    pub n_foreign: usize,
}

/// A pending snapshot.
pub struct Pending {
    /// The index of its folder.
    pub folder: usize,
    /// Its name, which is also its id.
    pub name: Name,
    /// The file.
    pub path: PathBuf,
    /// The accepted snapshot; `None` if this one is new.
    pub accepted: Option<Snapshot>,
    /// Why the accepted snapshot cannot be read, if it exists and cannot.
    pub unreadable: Option<String>,
    pub proposed: Snapshot,
    /// Details that `fabc` wrote about the proposed snapshot.
    pub info: Info,
}

/// Finds the pending snapshots in the named places, or below the current folder.
pub fn find(places: &[PathBuf]) -> Result<ReviewItems, Failure> {
    let here = [PathBuf::from(".")];
    let places = if places.is_empty() { &here } else { places };
    let mut wanted: Vec<(PathBuf, Option<String>)> = Vec::new();
    for place in places {
        let metadata = fs::metadata(place).map_err(|error| {
            Failure::environment(format!("cannot read `{}`: {error}", place.display()))
        })?;
        if metadata.is_dir() {
            let mut left = MAX_FOLDERS;
            let mut folders = Vec::new();
            walk(place, 0, &mut left, &mut folders)?;
            wanted.extend(folders.into_iter().map(|folder| (folder, None)));
        } else {
            let file = place.file_name().and_then(|name| name.to_str());
            let file = file.ok_or_else(|| {
                Failure::usage(format!("`{}` has no readable name", place.display()))
            })?;
            wanted.push((place.with_file_name(FOLDER), Some(file.to_owned())));
        }
    }
    let mut found = ReviewItems {
        folders: Vec::new(),
        pending: Vec::new(),
        n_foreign: 0,
    };
    let mut seen: BTreeSet<PathBuf> = BTreeSet::new();
    for (path, source) in wanted {
        read(&path, source.as_deref(), &mut seen, &mut found)?;
    }
    Ok(found)
}

/// Adds the snapshot folders in and below a folder; follows only links that are snapshot folders themselves.
fn walk(
    folder: &Path,
    depth: usize,
    left: &mut usize,
    found: &mut Vec<PathBuf>,
) -> Result<(), Failure> {
    if folder.file_name().is_some_and(|name| name == FOLDER) {
        found.push(folder.to_owned());
        return Ok(());
    }
    *left = left.checked_sub(1).ok_or_else(|| {
        Failure::environment(format!(
            "there are more than {MAX_FOLDERS} folders to look through; name those that are meant"
        ))
    })?;
    let unreadable = |error: std::io::Error| {
        Failure::environment(format!("cannot read `{}`: {error}", folder.display()))
    };
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        // A named folder must be readable; an unreadable one below it is skipped.
        Err(error) if depth == 0 => return Err(unreadable(error)),
        Err(_) => return Ok(()),
    };
    let mut below = Vec::new();
    for entry in entries {
        let entry = entry.map_err(unreadable)?;
        let name = entry.file_name();
        let is_skipped = name
            .to_str()
            .is_some_and(|name| name.starts_with('.') || SKIPPED.contains(&name));
        let is_wanted = entry.file_type().is_ok_and(|kind| match name == FOLDER {
            // The walk does not go below it, so a link cannot cause a cycle.
            true => kind.is_dir() || (kind.is_symlink() && entry.path().is_dir()),
            false => kind.is_dir(),
        });
        if !is_skipped && is_wanted {
            below.push(match depth == 0 && folder == Path::new(".") {
                true => PathBuf::from(name),
                false => entry.path(),
            });
        }
    }
    below.sort();
    match depth < MAX_DEPTH {
        true => below
            .iter()
            .try_for_each(|folder| walk(folder, depth + 1, left, found)),
        false => Ok(()),
    }
}

fn read(
    path: &Path,
    source: Option<&str>,
    seen: &mut BTreeSet<PathBuf>,
    found: &mut ReviewItems,
) -> Result<(), Failure> {
    let folder = Folder::open(path).map_err(Failure::environment)?;
    let number = found.folders.len();
    for name in folder.pending_names() {
        let path = folder.pending_path(name);
        let proposed = match folder.pending(name) {
            Ok(Some(proposed)) => proposed,
            Ok(None) => continue,
            Err(_) if !name.as_str().contains(SCENE) => {
                found.n_foreign += 1;
                continue;
            }
            Err(error) => return Err(unreadable(&path, &error)),
        };
        let Some(info) = proposed.metadata.info.clone() else {
            found.n_foreign += 1;
            continue;
        };
        let is_meant =
            source.is_none_or(|source| proposed.metadata.source.as_deref() == Some(source));
        let place = fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
        if !is_meant || !seen.insert(place) {
            continue;
        }
        let (accepted, unreadable) = match folder.accepted(name) {
            Ok(accepted) => (accepted, None),
            // A picture that is kept out of version control is missing here, and is proposed again.
            Err(SnapshotError::PictureMissing { .. }) => (None, None),
            Err(error) => (None, Some(error.to_string())),
        };
        found.pending.push(Pending {
            folder: number,
            name: name.clone(),
            path,
            accepted,
            unreadable,
            proposed,
            info,
        });
    }
    found.folders.push(folder);
    Ok(())
}

/// Reports why a pending snapshot cannot be read, such as an unresolved merge conflict, and what to do.
fn unreadable(path: &Path, error: &SnapshotError) -> Failure {
    let mut message = error.to_string();
    if let Some(line) = conflict(path) {
        message.push_str(&format!("; line {line} begins a merge conflict"));
    }
    Failure::environment(format!(
        "{message}; run `fabc snap` again, which proposes anew what cannot be read"
    ))
}

/// Returns the line, from 1, at which the first merge conflict of a file begins.
fn conflict(path: &Path) -> Option<usize> {
    let is_file = fs::symlink_metadata(path).is_ok_and(|found| found.is_file());
    let file = fs::File::open(path).ok().filter(|_| is_file)?;
    let mut bytes = Vec::new();
    file.take(MAX_LOOKED_THROUGH_BYTES)
        .read_to_end(&mut bytes)
        .ok()?;
    let at = bytes
        .split(|byte| *byte == b'\n')
        .position(|line| line.starts_with(b"<<<<<<<"))?;
    Some(at + 1)
}

impl Pending {
    /// Returns the file of the proposed picture, if it is one.
    pub fn picture_file(&self) -> Option<PathBuf> {
        match self.proposed.contents {
            Contents::Picture(_) => Some(self.path.with_added_extension("png")),
            Contents::Text(_) => None,
        }
    }

    /// Returns both texts, if a text changed.
    pub fn texts(&self) -> Option<(&str, &str)> {
        match (&self.accepted.as_ref()?.contents, &self.proposed.contents) {
            (Contents::Text(before), Contents::Text(after)) => Some((before, after)),
            _ => None,
        }
    }

    /// Returns both pictures, if a picture changed.
    pub fn pictures(&self) -> Option<(&[u8], &[u8])> {
        match (&self.accepted.as_ref()?.contents, &self.proposed.contents) {
            (Contents::Picture(before), Contents::Picture(after)) => Some((before, after)),
            _ => None,
        }
    }
}
