//! Files that are written atomically, and read up to a size limit.
//!
//! Input files are untrusted: an endless file, a device or a pipe is refused with a reason.

use crate::kinds::{Kind, without_mark};
use serde::de::DeserializeOwned;
use std::fs::{self, File, Permissions};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Writes a file so that a crash leaves either the old content or the new, never a mixture.
///
/// The bytes go to a temporary file beside it, which is synced and then renamed.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace(path, bytes, None)
}

/// Gives an existing file new content as [`write_whole`] does, and keeps its permissions; symbolic links are followed.
pub fn rewrite(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let path = fs::canonicalize(path)?;
    replace(&path, bytes, Some(fs::metadata(&path)?.permissions()))
}

/// Puts a new file in the place of another, or of none.
fn replace(path: &Path, bytes: &[u8], permissions: Option<Permissions>) -> io::Result<()> {
    let neighbour = neighbour(path);
    let written = (|| {
        let mut file = File::create(&neighbour)?;
        if let Some(permissions) = permissions {
            // Before the content, which others may not be allowed to read.
            file.set_permissions(permissions)?;
        }
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&neighbour, path)
    })();
    match written {
        Ok(()) => sync_folder(path),
        Err(_) => drop(fs::remove_file(&neighbour)),
    }
    written
}

/// Returns an unused name beside a file, for this process.
fn neighbour(path: &Path) -> PathBuf {
    static UNIQUE: AtomicU32 = AtomicU32::new(0);
    let number = UNIQUE.fetch_add(1, Ordering::Relaxed);
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.{number}.part", std::process::id()));
    path.with_file_name(name)
}

/// A new name is durable only once its folder is synced; not every system allows opening a folder.
fn sync_folder(path: &Path) {
    if let Some(folder) = path.parent() {
        // The folder of a bare name is empty.
        let _ = File::open(Path::new(".").join(folder)).and_then(|folder| folder.sync_all());
    }
}

/// Reads a regular file of at most `max_bytes`; fails with the reason.
///
/// Devices and pipes have no length, so they are refused.
pub fn read(path: &Path, max_bytes: u64) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let read = open_bounded(path, max_bytes)?.read_to_end(&mut bytes);
    read.map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Opens a regular file of at most `max_bytes` for reading; fails with the reason.
pub(crate) fn open_bounded(path: &Path, max_bytes: u64) -> Result<io::Take<File>, String> {
    let information = fs::metadata(path).map_err(|error| error.to_string())?;
    if information.is_dir() {
        return Err("it is a directory, not a file".to_owned());
    }
    if !information.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    if information.len() > max_bytes {
        return Err(format!("it is longer than the limit of {max_bytes} bytes"));
    }
    let file = File::open(path).map_err(|error| error.to_string())?;
    Ok(file.take(max_bytes))
}

/// Reads a regular file of at most `max_bytes` of UTF-8, without its byte-order mark; fails with the reason.
pub fn read_text(path: &Path, max_bytes: u64) -> Result<String, String> {
    text(without_mark(&read(path, max_bytes)?).to_vec())
}

/// Reads a regular file of at most `max_bytes` that holds one JSON value; fails with the reason.
pub fn read_json<T: DeserializeOwned>(path: &Path, max_bytes: u64) -> Result<T, String> {
    serde_json::from_str(&read_text(path, max_bytes)?).map_err(|error| error.to_string())
}

/// Returns bytes as text, with the byte-order mark that they may have; fails with what they are instead.
pub fn text(bytes: Vec<u8>) -> Result<String, String> {
    if let Some(kind) = Kind::of_text(&bytes) {
        return Err(kind.sentence());
    }
    String::from_utf8(bytes).map_err(|error| {
        let (at, bytes) = (error.utf8_error().valid_up_to(), error.as_bytes());
        if let Some(kind) = Kind::of(bytes) {
            return kind.sentence();
        }
        let line = 1 + bytes[..at].iter().filter(|byte| **byte == b'\n').count();
        format!(
            "it is not UTF-8 text: byte {at}, in line {line}, is 0x{:02x}; save it as UTF-8",
            bytes[at]
        )
    })
}

/// Returns whether a file name ends in `.ENDING`, ignoring case.
pub fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// Returns the line, from 1, of the byte at `offset`.
pub fn line_of(text: &str, offset: usize) -> usize {
    let before = text.bytes().take(offset);
    1 + before.filter(|byte| *byte == b'\n').count()
}

/// Makes the next free folder `NAME-0001`, `NAME-0002` and so on in a folder, which is made too.
///
/// Fails if a folder cannot be made, and after 9999 of them.
pub fn next_folder(parent: &Path, name: &str) -> std::io::Result<PathBuf> {
    std::fs::create_dir_all(parent)?;
    for number in 1..=9999u32 {
        let path = parent.join(format!("{name}-{number:04}"));
        match std::fs::create_dir(&path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            made => return made.map(|()| path),
        }
    }
    Err(std::io::Error::other(format!(
        "it holds 9999 folders `{name}-NNNN` already; name a folder with `--out`"
    )))
}

#[cfg(all(test, unix))]
#[path = "tests/files.rs"]
mod tests;
