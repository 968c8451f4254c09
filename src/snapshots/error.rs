//! Why a snapshot folder cannot be read or changed.

use std::io;
use std::path::{Path, PathBuf};

/// Why a snapshot folder cannot be read or changed.
#[derive(Debug, thiserror::Error)]
pub enum SnapshotError {
    /// A file or folder cannot be read.
    #[error("cannot read `{path}`: {why}")]
    Unreadable {
        /// The file or folder.
        path: PathBuf,
        /// The system's message.
        why: String,
    },
    /// A file or folder cannot be written.
    #[error("cannot change `{path}`: {why}")]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// The system's message.
        why: String,
    },
    /// A file does not have the snapshot format.
    #[error("`{path}` is not a snapshot that can be read: {why}")]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// A file exceeds the size limit of snapshots.
    #[error("`{path}` is larger than {most} bytes, the most that a snapshot may have")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The limit.
        most: u64,
    },
    /// A folder holds too many files.
    #[error("`{path}` holds more than {most} files")]
    TooMany {
        /// The folder.
        path: PathBuf,
        /// The limit.
        most: usize,
    },
    /// The picture of a snapshot is missing.
    #[error("`{picture}` is missing, the picture of the snapshot `{path}`")]
    PictureMissing {
        /// The snapshot.
        path: PathBuf,
        /// Where its picture should be.
        picture: PathBuf,
    },
    /// A name is not valid for a snapshot.
    #[error("`{name}` cannot name a snapshot: {why}")]
    Name {
        /// The name.
        name: String,
        /// What is wrong.
        why: &'static str,
    },
    /// Another process is changing the folder.
    #[error("another fabc is changing `{path}`; try again when it has ended")]
    InUse {
        /// The folder.
        path: PathBuf,
    },
    /// The folder of an interrupted change holds something that fabc did not write.
    #[error("`{path}` is not what an interrupted fabc leaves: {why}; look at it, and remove it")]
    Foreign {
        /// The file or folder.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// A change names the same snapshot twice.
    #[error("one change names the snapshot `{name}` twice")]
    Twice {
        /// The snapshot.
        name: String,
    },
    /// The pending snapshot is not the one that was shown.
    #[error("`{path}` has changed since it was shown; nothing was accepted, look at it again")]
    Changed {
        /// The pending file.
        path: PathBuf,
    },
}

impl SnapshotError {
    /// Reports that a file or folder cannot be read.
    pub fn unreadable(path: &Path, error: &io::Error) -> SnapshotError {
        SnapshotError::Unreadable {
            path: path.to_owned(),
            why: error.to_string(),
        }
    }

    /// Reports that a file or folder cannot be written.
    pub fn unwritable(path: &Path, error: &io::Error) -> SnapshotError {
        SnapshotError::Unwritable {
            path: path.to_owned(),
            why: error.to_string(),
        }
    }
}
