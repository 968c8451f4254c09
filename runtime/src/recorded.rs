//! Finds the recorded data for this crate's unit tests, or counts a test as skipped.
//!
//! In: `FABC_REFERENCE_DATA`, and the file named by `FABC_SKIPPED_FILE`, which `make test` reads.
#![allow(clippy::unwrap_used)]

use std::io::Write;
use std::path::PathBuf;

/// The recorded data, or `None` where it is not there; the test then counts as skipped.
pub(crate) fn recorded_data(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("FABC_REFERENCE_DATA").map(PathBuf::from);
    if folder.is_none() {
        eprintln!("skipped: {test}");
        if let Some(file) = std::env::var_os("FABC_SKIPPED_FILE") {
            let mut file = std::fs::OpenOptions::new()
                .create(true)
                .append(true)
                .open(file)
                .unwrap();
            writeln!(file, "{test}").unwrap();
        }
    }
    folder
}
