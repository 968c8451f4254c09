//! Files named by a task, which must be below its folder.
//!
//! In: the folder of the task's file and a [`FileRef`]. Out: a path, or why there is none. Links that lead out of the
//! folder are refused: a stranger's task must not show a model files from elsewhere.

use crate::error::RunError;
use fab_program::FileRef;
use std::fs;
use std::path::{Path, PathBuf};

/// Returns the path of a file; `folder` contains the task's file.
pub fn resolve(folder: &Path, file: &FileRef) -> Result<PathBuf, RunError> {
    let path = folder.join(&file.path);
    let real = |path: &Path| {
        fs::canonicalize(path)
            .map_err(|error| RunError::Failed(format!("cannot read `{}`: {error}", path.display())))
    };
    let (root, target) = (real(&Path::new(".").join(folder))?, real(&path)?);
    if !target.starts_with(&root) {
        return Err(RunError::Failed(format!(
            "`{}` leads out of the task's folder, to `{}`",
            path.display(),
            target.display()
        )));
    }
    Ok(path)
}

#[cfg(test)]
#[path = "tests/task_files.rs"]
mod tests;
