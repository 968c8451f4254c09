//! Reads files of a bounded size, whatever their length is said to be.
//!
//! In: a path, and how long its file may be. Out: bytes or text, else why not, in words; and the line that a place in
//! a text is on, for messages that must not quote it.

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

/// Reads a regular file of at most `max_bytes` of UTF-8; says why where that is not to be had.
pub fn read_text(path: &Path, max_bytes: u64) -> Result<String, String> {
    String::from_utf8(read(path, max_bytes)?).map_err(|_| "it is no UTF-8 text".to_owned())
}

/// Returns the line, from 1, of the byte at `offset`.
pub(crate) fn line_of(text: &str, offset: usize) -> usize {
    let before = text.bytes().take(offset);
    1 + before.filter(|byte| *byte == b'\n').count()
}
