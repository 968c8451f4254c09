//! Reads files of a bounded size, whatever their length is said to be.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

/// Reads a regular file of at most `max_bytes`; says why where that is not to be had.
///
/// A device or a pipe has no length to ask for, so that neither is read.
pub fn read(path: &Path, max_bytes: u64) -> Result<Vec<u8>, String> {
    let information = fs::metadata(path).map_err(|error| error.to_string())?;
    if information.is_dir() {
        return Err("it is a directory".to_owned());
    }
    if !information.is_file() {
        return Err("it is no regular file".to_owned());
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| error.to_string())?;
    file.take(max_bytes + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| error.to_string())?;
    if bytes.len() as u64 > max_bytes {
        return Err(format!("it is longer than the limit of {max_bytes} bytes"));
    }
    Ok(bytes)
}
