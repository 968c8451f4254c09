//! Backs up a file that is about to be replaced.

use crate::exit::Failure;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The most backups of a file.
const MAX_BACKUPS: u32 = 9999;

/// Copies a file to the first free `FILE.before-N`; returns that name, or `None` if there is no file.
pub fn copy(path: &Path) -> Result<Option<PathBuf>, Failure> {
    let failed = |error| {
        Failure::environment(format!(
            "cannot keep a copy of `{}`, so it is not replaced: {error}",
            path.display()
        ))
    };
    let mut old = match fs::File::open(path) {
        Ok(old) => old,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(failed(error)),
    };
    for number in 1..=MAX_BACKUPS {
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(format!(".before-{number}"));
        let earlier = path.with_file_name(name);
        match fs::File::create_new(&earlier) {
            Ok(mut file) => {
                let copied = std::io::copy(&mut old, &mut file).and_then(|_| file.sync_all());
                return copied.map(|()| Some(earlier)).map_err(failed);
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(failed(error)),
        }
    }
    Err(failed(ErrorKind::AlreadyExists.into()))
}
