//! Writes several files into a folder together, or none.
//!
//! In: their bytes, piece by piece. Out: the files in their final places. They are first written to a staging folder;
//! existing files are never replaced.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Files staged for a folder; dropping it before [`Staging::commit`] leaves nothing behind.
pub struct Staging {
    folder: PathBuf,
    /// Folders created for it, outermost first.
    made: Vec<PathBuf>,
    aside: PathBuf,
    units: Vec<PathBuf>,
}

impl Staging {
    /// Creates a staging folder in `folder`, which is created too if it is missing.
    ///
    /// - `name`: a file name that distinguishes it from others of this process.
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

    /// Returns the folder in which files are staged.
    #[cfg_attr(not(feature = "runtime"), expect(dead_code))]
    pub fn aside(&self) -> &Path {
        &self.aside
    }

    /// Registers a file or a whole folder, relative to both folders, for [`Staging::commit`].
    ///
    /// Units are moved in the order in which they were added.
    pub fn include(&mut self, unit: impl Into<PathBuf>) {
        self.units.push(unit.into());
    }

    /// Stages a file.
    pub fn write(&mut self, unit: &Path, bytes: &[u8]) -> io::Result<()> {
        let path = self.aside.join(unit);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fab_base::files::write_whole(&path, bytes)?;
        self.include(unit);
        Ok(())
    }

    /// Moves all units into place; if one move fails, undoes the others.
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
            // If a file cannot be removed again, the error that led here is still reported.
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
        // Leftovers do no harm; a created folder that now holds other files stays.
        let _ = fs::remove_dir_all(&self.aside);
        for folder in self.made.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Creates a folder and its missing parents, and adds those that it created to `made`.
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
