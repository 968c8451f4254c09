//! Files that are written whole or not at all, and read up to a limit.
//!
//! What is read may be a stranger's: a file that never ends, a device or a pipe is refused with the reason in words.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

/// Writes a file so that a crash leaves the old content or the new, never a part.
///
/// The bytes go to a neighbour first, are synced, and take the name last.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    static UNIQUE: AtomicU32 = AtomicU32::new(0);
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(
        ".{}.{}.part",
        std::process::id(),
        UNIQUE.fetch_add(1, Ordering::Relaxed)
    ));
    let neighbour = path.with_file_name(name);
    let written = File::create(&neighbour).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    let moved = written.and_then(|()| fs::rename(&neighbour, path));
    if let (Ok(()), Some(folder)) = (&moved, path.parent()) {
        // The new name is on disk only once its folder is; not every system lets a folder be opened.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
    if moved.is_err() {
        // What remains is not the file that was asked for; its own removal may fail as well.
        let _ = fs::remove_file(&neighbour);
    }
    moved
}

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
pub fn line_of(text: &str, offset: usize) -> usize {
    let before = text.bytes().take(offset);
    1 + before.filter(|byte| *byte == b'\n').count()
}
