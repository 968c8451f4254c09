//! Backs up a file that is about to be replaced.

use crate::exit::Failure;
use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

const MAX_BACKUPS: u32 = 9999;

/// Copies a file to the first free `FILE.before-N`; returns that name, or `None` if there is no file.
pub fn copy(path: &Path) -> Result<Option<PathBuf>, Failure> {
    copied(path).map_err(|error| {
        Failure::environment(format!(
            "cannot keep a copy of `{}`, so it is not replaced: {error}",
            path.display()
        ))
    })
}

fn copied(path: &Path) -> io::Result<Option<PathBuf>> {
    let mut old = match File::open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        old => old?,
    };
    for number in 1..=MAX_BACKUPS {
        let earlier = path.with_added_extension(format!("before-{number}"));
        match File::create_new(&earlier) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            file => {
                let mut file = file?;
                io::copy(&mut old, &mut file)?;
                file.sync_all()?;
                return Ok(Some(earlier));
            }
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}
