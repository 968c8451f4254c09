//! Files that a program names.

use serde::{Deserialize, Serialize};

/// One source file's name and content hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceStamp {
    /// The path relative to the entry file's folder, with `/` as separator: the same wherever the folder is.
    pub name: String,
    /// SHA-256 of the text, hex.
    pub sha256: String,
}

/// A file that a task names: a picture, or particle positions.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileRef {
    /// Path relative to the entry file's folder, with `/` as separator; never above it.
    pub path: String,
}
