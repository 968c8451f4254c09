//! Finds the files that a verb reads for a task.

use crate::sources::{self, Disk};
use fab_compiler::{LoadError, Loader};
use fab_program::{ClothStart, FileRef, PINS_FILE, Program, Subgoals, pins_folder};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Returns the files of a command line and all files that they use, including missing ones.
pub fn files(entries: &[String], others: &[PathBuf]) -> BTreeSet<PathBuf> {
    let mut files: BTreeSet<PathBuf> = others.iter().cloned().collect();
    for entry in entries {
        let loader = RecordingLoader {
            disk: Disk::beside(entry),
            asked: RefCell::default(),
        };
        let compiled = fab_compiler::compile(entry, &loader);
        files.extend(loader.asked.into_inner());
        let folder = sources::folder_of(entry);
        for program in compiled.iter().flat_map(|compiled| &compiled.programs) {
            files.extend(beside(program).iter().map(|path| folder.join(path)));
        }
    }
    files
}

/// A loader that reads from disk and records the requested files.
struct RecordingLoader {
    disk: Disk,
    asked: RefCell<BTreeSet<PathBuf>>,
}

impl Loader for RecordingLoader {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        self.asked.borrow_mut().insert(PathBuf::from(name));
        self.disk.load(name)
    }
}

/// Returns the files that a task names, relative to its own file, and its pinned pictures.
fn beside(program: &Program) -> Vec<PathBuf> {
    let examples = program.stages.iter().flat_map(|stage| &stage.examples);
    let mut named: Vec<&FileRef> = examples.flat_map(|example| &example.images).collect();
    named.extend(program.demos.iter().map(|demos| &demos.file));
    if let ClothStart::File { file } = &program.cloth.start {
        named.push(file);
    }
    let mut pins = Vec::new();
    match &program.subgoals {
        Some(Subgoals::Images { images }) => named.extend(images.iter().map(|image| &image.file)),
        Some(Subgoals::Demonstrate { folds }) => {
            let folder = pins_folder(&program.title());
            let pictures = (0..=folds.len()).map(|number| format!("{number}.png"));
            // `fabc subgoals` writes this description after the pictures.
            let files = pictures.chain([PINS_FILE.to_owned()]);
            pins.extend(files.map(|file| Path::new(&folder).join(file)));
        }
        None => {}
    }
    let named = named.into_iter().map(|file| PathBuf::from(&file.path));
    named.chain(pins).collect()
}
