//! Finds pending snapshots, below folders or of files.
//!
//! In: the places named on the command line. Out: each pending snapshot with the accepted one. Snapshots that other
//! tools wrote into such folders are counted and left alone. For our own, an unreadable pending snapshot is an error; an
//! unreadable accepted one counts as absent, since the pending one was made without it.

use crate::exit::Failure;
use crate::snapshots::{Contents, FOLDER, Folder, Info, Name, Side, Snapshot};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use walkdir::{DirEntry, WalkDir};

/// Folders with generated or downloaded files.
const SKIPPED: [&str; 3] = ["target", "node_modules", "runs"];

/// Everything to review.
#[derive(Default)]
pub struct ReviewItems {
    /// The pending snapshots, by folder and name.
    pub pending: Vec<Pending>,
    /// How many pending snapshots were not written by `fabc`.
    pub n_foreign: usize,
}

/// A pending snapshot.
pub struct Pending {
    pub folder: Rc<Folder>,
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
    let mut found = ReviewItems::default();
    let mut seen = BTreeSet::new();
    for place in places {
        if place.is_file() {
            let file = place.file_name().and_then(|name| name.to_str());
            found.add(&place.with_file_name(FOLDER), file, &mut seen)?;
            continue;
        }
        for folder in snapshot_folders(place)? {
            found.add(&folder, None, &mut seen)?;
        }
    }
    Ok(found)
}

/// Returns the snapshot folders in and below a folder; follows only links that are snapshot folders themselves.
fn snapshot_folders(place: &Path) -> Result<Vec<PathBuf>, Failure> {
    let is_meant = |entry: &DirEntry| {
        let name = entry.file_name().to_string_lossy();
        entry.depth() == 0 || !(name.starts_with('.') || SKIPPED.contains(&&*name))
    };
    let mut folders = Vec::new();
    let mut entries = WalkDir::new(place).sort_by_file_name().into_iter();
    while let Some(entry) = entries.next() {
        let entry = match entry {
            Ok(entry) => entry,
            Err(error) if error.depth() == 0 => {
                let why = error.io_error().map(ToString::to_string);
                return Err(Failure::environment(format!(
                    "cannot read `{}`: {}",
                    place.display(),
                    why.unwrap_or_default()
                )));
            }
            // An unreadable folder below a named one is skipped.
            Err(_) => continue,
        };
        let path = entry.path();
        if !is_meant(&entry) {
            if entry.file_type().is_dir() {
                entries.skip_current_dir();
            }
        } else if path.file_name().is_some_and(|name| name == FOLDER) && path.is_dir() {
            folders.push(path.strip_prefix(".").unwrap_or(path).to_owned());
            if entry.file_type().is_dir() {
                entries.skip_current_dir();
            }
        }
    }
    Ok(folders)
}

impl ReviewItems {
    /// Adds what is pending in a folder, or only that of one source file.
    fn add(
        &mut self,
        path: &Path,
        source: Option<&str>,
        seen: &mut BTreeSet<PathBuf>,
    ) -> Result<(), Failure> {
        let folder = Rc::new(Folder::open(path).map_err(Failure::environment)?);
        for name in &folder.pending {
            let path = folder.file(name, Side::Pending);
            let proposed = match folder.read(name, Side::Pending) {
                Ok(Some(proposed)) => proposed,
                Ok(None) => continue,
                Err(_) if !name.is_ours() => {
                    self.n_foreign += 1;
                    continue;
                }
                Err(error) => {
                    return Err(Failure::environment(error)
                        .saying("run `fabc snap` again, which proposes anew what cannot be read"));
                }
            };
            let Some(info) = proposed.metadata.info.clone() else {
                self.n_foreign += 1;
                continue;
            };
            let is_meant =
                source.is_none_or(|source| proposed.metadata.source.as_deref() == Some(source));
            let place = fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
            if !is_meant || !seen.insert(place) {
                continue;
            }
            let (accepted, unreadable) = match folder.read(name, Side::Accepted) {
                Ok(accepted) => (accepted, None),
                Err(error) => (None, Some(error.to_string())),
            };
            self.pending.push(Pending {
                folder: folder.clone(),
                name: name.clone(),
                path,
                accepted,
                unreadable,
                proposed,
                info,
            });
        }
        Ok(())
    }
}

impl Pending {
    /// Returns the file of the proposed picture, if it is one.
    pub fn picture_file(&self) -> Option<PathBuf> {
        match self.proposed.contents {
            Contents::Picture(_) => Some(self.path.with_added_extension("png")),
            Contents::Text(_) => None,
        }
    }

    /// Returns both pictures, if a picture changed.
    pub fn pictures(&self) -> Option<[&[u8]; 2]> {
        match (&self.accepted.as_ref()?.contents, &self.proposed.contents) {
            (Contents::Picture(before), Contents::Picture(after)) => Some([before, after]),
            _ => None,
        }
    }
}
