//! The file operations that a change of a snapshot folder is made of, one by one.
//!
//! In: paths and bytes. Out: what the system says. That a change is whole wherever it stops is tested by a disk
//! that stops after each of them; so nothing else in this folder writes.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// What a change does to files.
pub trait Disk {
    /// Makes a folder; one that exists is no error.
    fn make_folder(&self, path: &Path) -> io::Result<()>;
    /// Writes a new file.
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;
    /// Waits until the bytes of a file, or the names in a folder, outlast a loss of power.
    fn sync(&self, path: &Path) -> io::Result<()>;
    /// Gives a file another name, in place of the file that has it.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Removes a file.
    fn remove(&self, path: &Path) -> io::Result<()>;
    /// Removes a folder with all that is in it; a link is not followed.
    fn remove_folder(&self, path: &Path) -> io::Result<()>;
}

/// The system's own files.
#[derive(Debug)]
pub struct System;

impl Disk for System {
    fn make_folder(&self, path: &Path) -> io::Result<()> {
        fs::create_dir_all(path)
    }

    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        File::create_new(path)?.write_all(bytes)
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        match File::open(path) {
            Ok(file) => file.sync_all(),
            // Not every system lets a folder be opened.
            Err(_) if path.is_dir() => Ok(()),
            Err(error) => Err(error),
        }
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }

    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        fs::remove_dir_all(path)
    }
}
