//! Files that appear in a folder together, or not at all.
//!
//! In: their bytes, piece by piece. Out: the files in their places. They are written beside their places first;
//! what exists is never replaced.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Files on their way into a folder; dropped before [`Staging::commit`], it leaves nothing behind.
pub struct Staging {
    folder: PathBuf,
    /// Folders that were made for it, outermost first.
    made: Vec<PathBuf>,
    aside: PathBuf,
    units: Vec<PathBuf>,
}

impl Staging {
    /// Makes a folder beside the places in `folder`, which is made too where it is missing.
    ///
    /// - `name`: a file's name that tells it from others of this process.
    pub fn begin(folder: &Path, name: &str) -> io::Result<Staging> {
        let mut staging = Staging {
            folder: folder.to_owned(),
            made: Vec::new(),
            aside: folder.join(format!(".{name}.{}.part", std::process::id())),
            units: Vec::new(),
        };
        make_folders(folder, &mut staging.made)?;
        fs::create_dir(&staging.aside)?;
        Ok(staging)
    }

    /// Returns the folder in which files are written before they take their places.
    #[cfg_attr(not(feature = "runtime"), expect(dead_code))]
    pub fn aside(&self) -> &Path {
        &self.aside
    }

    /// Says that a file or a whole folder, relative to both folders, is to take its place with the others.
    ///
    /// What is named last takes its place last.
    pub fn include(&mut self, unit: impl Into<PathBuf>) {
        self.units.push(unit.into());
    }

    /// Writes a file that is to take its place with the others.
    pub fn write(&mut self, unit: &Path, bytes: &[u8]) -> io::Result<()> {
        let path = self.aside.join(unit);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fab_base::files::write_whole(&path, bytes)?;
        self.include(unit);
        Ok(())
    }

    /// Moves all of them to their places; where that fails, none of them is left there.
    pub fn commit(mut self) -> io::Result<()> {
        let mut placed = Vec::new();
        let moved = self.units.clone().iter().try_for_each(|unit| {
            let place = self.folder.join(unit);
            if let Some(folder) = place.parent() {
                make_folders(folder, &mut self.made)?;
            }
            if place.symlink_metadata().is_ok() {
                let why = format!("`{}` exists already", place.display());
                return Err(io::Error::new(io::ErrorKind::AlreadyExists, why));
            }
            fs::rename(self.aside.join(unit), &place)?;
            placed.push(place);
            Ok(())
        });
        if moved.is_ok() {
            self.made.clear();
        } else {
            // What cannot be taken away again is reported by the failure that led here.
            for place in placed.iter().rev() {
                let _ = match place.is_dir() {
                    true => fs::remove_dir_all(place),
                    false => fs::remove_file(place),
                };
            }
        }
        moved
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // Of no use to anybody; a folder that holds others' files by now stays.
        let _ = fs::remove_dir_all(&self.aside);
        for folder in self.made.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Makes a folder and those above it, and adds those that were missing to `made`.
fn make_folders(folder: &Path, made: &mut Vec<PathBuf>) -> io::Result<()> {
    if folder.as_os_str().is_empty() || folder.is_dir() {
        return Ok(());
    }
    if let Some(above) = folder.parent() {
        make_folders(above, made)?;
    }
    fs::create_dir(folder)?;
    made.push(folder.to_owned());
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn files_that_were_not_committed_leave_nothing_behind() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("new/folder");
        let mut staging = Staging::begin(&folder, "a").unwrap();
        staging.write(Path::new("lib/a.fab"), b"a").unwrap();
        drop(staging);
        assert_eq!(names(root.path()), Vec::<String>::new());
    }

    #[test]
    fn a_place_that_is_taken_keeps_every_file_from_its_place() {
        let root = tempfile::tempdir().unwrap();
        let mut staging = Staging::begin(root.path(), "a").unwrap();
        for unit in ["lib/a.fab", "pictures/0.png", "a.fab"] {
            staging.write(Path::new(unit), b"new").unwrap();
        }
        fs::write(root.path().join("a.fab"), "old").unwrap();
        let error = staging.commit().unwrap_err();
        assert!(error.to_string().contains("exists already"), "{error}");
        assert_eq!(names(root.path()), ["a.fab"]);
        let kept = fs::read_to_string(root.path().join("a.fab")).unwrap();
        assert_eq!(kept, "old");
    }

    #[test]
    fn committed_files_stand_in_their_places_alone() {
        let root = tempfile::tempdir().unwrap();
        let mut staging = Staging::begin(root.path(), "a").unwrap();
        staging.write(Path::new("lib/a.fab"), b"new").unwrap();
        staging.commit().unwrap();
        assert_eq!(names(root.path()), ["lib"]);
        assert_eq!(names(&root.path().join("lib")), ["a.fab"]);
    }
}
