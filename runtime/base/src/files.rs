//! Files that are written atomically, and read up to a size limit.
//!
//! Input files are untrusted: an endless file, a device or a pipe is refused with a reason.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

/// Writes a file so that a crash leaves either the old content or the new, never a mixture.
///
/// The bytes go to a temporary file beside it, which is synced and then renamed.
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
        // The new name is durable only once the folder is synced; not every system allows opening a folder.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
    if moved.is_err() {
        // The temporary file is left over; removing it may fail as well.
        let _ = fs::remove_file(&neighbour);
    }
    moved
}

/// Reads a regular file of at most `max_bytes`; fails with the reason.
///
/// Devices and pipes have no length, so they are refused.
pub fn read(path: &Path, max_bytes: u64) -> Result<Vec<u8>, String> {
    let information = fs::metadata(path).map_err(|error| error.to_string())?;
    if information.is_dir() {
        return Err("it is a directory".to_owned());
    }
    if !information.is_file() {
        return Err("it is not a regular file".to_owned());
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

/// Reads a regular file of at most `max_bytes` of UTF-8; fails with the reason.
pub fn read_text(path: &Path, max_bytes: u64) -> Result<String, String> {
    String::from_utf8(read(path, max_bytes)?).map_err(|_| "it is not UTF-8 text".to_owned())
}

/// Returns the line, from 1, of the byte at `offset`.
pub fn line_of(text: &str, offset: usize) -> usize {
    let before = text.bytes().take(offset);
    1 + before.filter(|byte| *byte == b'\n').count()
}
