//! Finds the files that a verb reads for a task.

use crate::sources::{self, Disk};
use fab_compiler::{Listed, LoadError, Loader, Wanted};
use fab_program::{PINS_FILE, Trial, pins_folder};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Returns the files of a command line and all files that they use, including missing ones.
pub fn files(entries: &[String], others: &[PathBuf]) -> BTreeSet<PathBuf> {
    let mut files: BTreeSet<PathBuf> = others.iter().cloned().collect();
    for entry in entries {
        let loader = RecordingLoader {
            disk: Disk::beside(entry),
            folder: sources::folder_of(entry),
            asked: RefCell::default(),
        };
        // Its findings are the verb's to report.
        let _ = fab_compiler::compile(entry, &loader);
        files.extend(loader.asked.into_inner());
    }
    files
}

/// A loader that reads from disk and records the requested files.
struct RecordingLoader {
    disk: Disk,
    folder: PathBuf,
    asked: RefCell<BTreeSet<PathBuf>>,
}

impl Loader for RecordingLoader {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        self.asked.borrow_mut().insert(PathBuf::from(name));
        self.disk.load(name)
    }

    fn look(&self, path: &str, _wanted: Wanted) -> Listed {
        self.asked.borrow_mut().insert(self.folder.join(path));
        Listed::Unknown
    }

    /// `fabc subgoals` writes this description after the pictures.
    fn trial(&self, title: &str) -> Option<Trial> {
        let pins = Path::new(&pins_folder(title)).join(PINS_FILE);
        self.asked.borrow_mut().insert(self.folder.join(pins));
        None
    }
}
