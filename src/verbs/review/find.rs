//! Finds pending snapshots, below folders or of files.
//!
//! In: the places named on the command line. Out: each pending snapshot with the accepted one. Snapshots that other
//! tools wrote into such folders are left alone. For our own, an unreadable pending snapshot is an error; an
//! unreadable accepted one counts as absent, since the pending one was made without it.

use crate::exit::Failure;
use crate::io::Io;
use crate::snapshots::{self, Contents, FOLDER, Folder, Info, Name, Side, Snapshot, picture_of};
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use walkdir::{DirEntry, WalkDir};

/// Folders with generated or downloaded files.
const SKIPPED: [&str; 3] = ["target", "node_modules", "runs"];

#[derive(Serialize)]
pub struct Pending {
    #[serde(skip)]
    pub folder: Rc<Folder>,
    /// Its name, which is also its id.
    #[serde(rename = "id")]
    pub name: Name,
    pub path: PathBuf,
    /// The file of the proposed picture, if it is one.
    pub file: Option<PathBuf>,
    /// The accepted snapshot; `None` if this one is new.
    #[serde(skip)]
    pub accepted: Option<Snapshot>,
    #[serde(skip)]
    pub proposed: Snapshot,
    /// Details that `fabc` wrote about the proposed snapshot.
    #[serde(flatten)]
    pub info: Info,
}

/// Finds the pending snapshots in the named places, or below the current folder; `only` is a part of their names.
pub fn find(places: &[PathBuf], only: Option<&str>, io: &Io) -> Result<Vec<Pending>, Failure> {
    let here = [PathBuf::from(".")];
    let places = if places.is_empty() { &here } else { places };
    let mut folders = BTreeSet::new();
    for place in places {
        if place.is_file() {
            let source = place.file_name().and_then(|name| name.to_str());
            folders.insert((place.with_file_name(FOLDER), source));
        } else {
            let found = snapshot_folders(place)?.into_iter();
            folders.extend(found.map(|folder| (folder, None)));
        }
    }
    let mut found = Vec::new();
    for (folder, source) in folders {
        found.extend(pending_in(&folder, source, only.unwrap_or_default(), io)?);
    }
    // A folder and a file beside it may both be named.
    let mut seen = BTreeSet::new();
    found.retain(|one| seen.insert(one.path.clone()));
    Ok(found)
}

/// Returns the snapshot folders in and below a folder; links are not followed.
fn snapshot_folders(place: &Path) -> Result<Vec<PathBuf>, Failure> {
    let is_meant = |entry: &DirEntry| {
        let name = entry.file_name().to_string_lossy();
        entry.depth() == 0 || !(name.starts_with('.') || SKIPPED.contains(&&*name))
    };
    let mut folders = Vec::new();
    for entry in WalkDir::new(place).into_iter().filter_entry(is_meant) {
        match entry {
            Ok(entry) if entry.file_type().is_dir() && entry.path().ends_with(FOLDER) => {
                let path = entry.path();
                folders.push(path.strip_prefix(".").unwrap_or(path).to_owned());
            }
            Err(error) if error.depth() == 0 => {
                let why = format!("cannot read `{}`: {error}", place.display());
                return Err(Failure::environment(why));
            }
            // An unreadable folder below a named one is skipped.
            _ => {}
        }
    }
    Ok(folders)
}

/// Returns what is pending in a folder, or only that of one source file.
fn pending_in(
    path: &Path,
    source: Option<&str>,
    only: &str,
    io: &Io,
) -> Result<Vec<Pending>, Failure> {
    let folder = Rc::new(Folder::open(path)?);
    let mut found = Vec::new();
    for name in folder.pending.iter().filter(|name| name.contains(only)) {
        let proposed = match folder.read(name, Side::Pending) {
            Err(_) if !snapshots::is_ours(name) => None,
            read => read.map_err(|failure| {
                failure.saying("run `fabc snap` again, which proposes anew what cannot be read")
            })?,
        };
        let info = proposed.as_ref().and_then(|it| it.metadata.info.clone());
        let (Some(proposed), Some(info)) = (proposed, info) else {
            continue;
        };
        if source.is_some() && proposed.metadata.source.as_deref() != source {
            continue;
        }
        let accepted = folder.read(name, Side::Accepted).unwrap_or_else(|why| {
            io.talk(&format!("counted as new: {why}"));
            None
        });
        let path = folder.file(name, Side::Pending);
        found.push(Pending {
            folder: folder.clone(),
            name: name.clone(),
            file: match &proposed.contents {
                Contents::Picture(_) => Some(picture_of(&path)),
                Contents::Text(_) => None,
            },
            path,
            accepted,
            proposed,
            info,
        });
    }
    Ok(found)
}

impl Pending {
    /// Names the files of the accepted and the proposed picture, for a viewer of pictures.
    pub fn pictures_to_look_at(&self) -> Option<String> {
        let proposed = self.file.as_ref()?.display();
        if self.pictures().is_none() {
            return Some(proposed.to_string());
        }
        let accepted = picture_of(&self.folder.file(&self.name, Side::Accepted));
        Some(format!("{} -> {proposed}", accepted.display()))
    }

    /// Returns both pictures, if a picture changed.
    pub fn pictures(&self) -> Option<[&[u8]; 2]> {
        match (&self.accepted.as_ref()?.contents, &self.proposed.contents) {
            (Contents::Picture(before), Contents::Picture(after)) => Some([before, after]),
            _ => None,
        }
    }
}
