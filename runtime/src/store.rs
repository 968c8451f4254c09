//! Files that are either whole or absent.

use std::fs::{self, File};
use std::io::{self, Write};
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
