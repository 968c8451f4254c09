//! Finds the recorded data, or counts a test as skipped; every crate's tests include this one file.
//!
//! In: `FABC_REFERENCE_DATA`, and the file named by `FABC_SKIPPED_FILE`, which `make test` reads.
#![allow(clippy::unwrap_used)]

use std::io::Write;
use std::path::PathBuf;

/// The recorded data, or `None` where it is not there; the test then counts as skipped.
pub fn recorded_data(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("FABC_REFERENCE_DATA").map(PathBuf::from);
    if folder.is_none() {
        count_as_skipped(test);
    }
    folder
}

/// Tells `make test` that a test could not do its work here: a Rust test has no word for that.
pub fn count_as_skipped(test: &str) {
    eprintln!("skipped: {test}");
    if let Some(file) = std::env::var_os("FABC_SKIPPED_FILE") {
        let opened = std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(file);
        writeln!(opened.unwrap(), "{test}").unwrap();
    }
}
