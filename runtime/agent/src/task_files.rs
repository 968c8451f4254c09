//! Files named by a task, which must be below its folder.
//!
//! In: the folder of the task's file and a [`FileRef`]. Out: a path, or why there is none. Links that lead out of the
//! folder are refused: a stranger's task must not show a model files from elsewhere.

use fab_picture::png::PictureError;
use fab_program::FileRef;
use std::fs;
use std::path::{Path, PathBuf};

/// Why a file of a task cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The file cannot be read; says why.
    #[error("cannot read `{0}`: {1}")]
    Unreadable(PathBuf, String),
    /// The file lies outside the folder; says where.
    #[error("`{0}` leads out of the task's folder, to `{1}`")]
    Outside(PathBuf, PathBuf),
    /// It is not a picture.
    #[error("the picture of an example cannot be used: {0}")]
    Picture(#[from] PictureError),
}

/// Returns the path of a file; `folder` contains the task's file.
pub fn resolve(folder: &Path, file: &FileRef) -> Result<PathBuf, FileError> {
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let path = folder.join(&file.path);
    let real = |path: &Path| {
        fs::canonicalize(path)
            .map_err(|error| FileError::Unreadable(path.to_owned(), error.to_string()))
    };
    let (root, target) = (real(folder)?, real(&path)?);
    if !target.starts_with(&root) {
        return Err(FileError::Outside(path, target));
    }
    Ok(path)
}

#[cfg(test)]
#[path = "tests/task_files.rs"]
mod tests;
