//! Finds what is pending: below folders, or of files.
//!
//! In: what the command line names. Out: the snapshot folders, and each pending snapshot beside the accepted one.
//! Snapshots that others wrote into such folders are counted and left alone. Of ours, a pending one that cannot be read
//! is an error, and an accepted one counts as absent: what is pending was made without it.

use crate::exit::Failure;
use crate::snapshots::{Contents, FOLDER, Folder, Info, Name, Snapshot, SnapshotError};
use std::collections::BTreeSet;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Folders that hold what was made or fetched.
const SKIPPED: [&str; 3] = ["target", "node_modules", "runs"];
/// How far below a named folder is looked, and the most folders that are.
const MAX_DEPTH: usize = 24;
const MAX_FOLDERS: usize = 100_000;
/// What stands before the scene in each name that `fabc` gives.
const SCENE: char = '@';
/// How much of a file that cannot be read is looked through for a merge conflict, bytes.
const MAX_LOOKED_THROUGH_BYTES: u64 = 4 << 20;

/// All that is to be reviewed.
pub struct Found {
    /// The snapshot folders that hold any of it.
    pub folders: Vec<Folder>,
    /// What is pending, by folder and name.
    pub pending: Vec<Pending>,
    /// How many pending snapshots are not of `fabc`.
    pub n_foreign: usize,
}

/// A pending snapshot.
pub struct Pending {
    /// Which of the folders it is in.
    pub folder: usize,
    /// Its name, which is its id too.
    pub name: Name,
    /// The file.
    pub path: PathBuf,
    /// What was accepted; none for a new one.
    pub accepted: Option<Snapshot>,
    /// Why what was accepted cannot be read, where there is any.
    pub unreadable: Option<String>,
    /// What is proposed.
    pub proposed: Snapshot,
    /// What `fabc` says of what is proposed.
    pub info: Info,
}

/// Finds what is pending in the named places, or below the current folder.
pub fn find(places: &[PathBuf]) -> Result<Found, Failure> {
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
    let mut found = Found {
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

/// Adds the snapshot folders in and below a folder; of links, only a snapshot folder itself is followed.
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
        // One that was named has to be readable; of those below it, none can be hidden by this.
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
            // Nothing below it is walked through, so that no link leads round in a circle.
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
    found: &mut Found,
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
            // A picture that is kept out of version control is absent, and is proposed anew.
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

/// Says why a pending snapshot cannot be read, where a merge left it undecided, and what to do.
fn unreadable(path: &Path, error: &SnapshotError) -> Failure {
    let mut message = error.to_string();
    if let Some(line) = conflict(path) {
        message.push_str(&format!("; line {line} begins a merge conflict"));
    }
    Failure::environment(format!(
        "{message}; run `fabc snap` again, which proposes anew what cannot be read"
    ))
}

/// Returns the first line of a file, from 1, that begins a merge conflict.
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
    /// Returns the file of the picture that is proposed, where it is one.
    pub fn picture_file(&self) -> Option<PathBuf> {
        match self.proposed.contents {
            Contents::Picture(_) => Some(self.path.with_added_extension("png")),
            Contents::Text(_) => None,
        }
    }

    /// Returns both texts, where it is a text that changes.
    pub fn texts(&self) -> Option<(&str, &str)> {
        match (&self.accepted.as_ref()?.contents, &self.proposed.contents) {
            (Contents::Text(before), Contents::Text(after)) => Some((before, after)),
            _ => None,
        }
    }

    /// Returns both pictures, where it is a picture that changes.
    pub fn pictures(&self) -> Option<(&[u8], &[u8])> {
        match (&self.accepted.as_ref()?.contents, &self.proposed.contents) {
            (Contents::Picture(before), Contents::Picture(after)) => Some((before, after)),
            _ => None,
        }
    }
}
