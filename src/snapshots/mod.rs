//! Snapshot files: prompts and pictures as the user last accepted them, and proposed new versions.
//!
//! In: a folder `snapshots/` in insta's file format. `NAME.snap` is accepted, `NAME.snap.new` is pending; a picture's
//! bytes lie beside its file as `NAME.snap.png` and `NAME.snap.new.png`.
//! Out: [`Snapshot`]s, and atomic changes of the folder, even if the process is stopped.
//! Callers decide which snapshots to make and what to do with pending ones.

mod change;
mod disk;
mod error;
mod folder;
mod format;
mod journal;
mod metadata;
mod name;

#[cfg(test)]
mod tests;

pub use change::Operation;
pub use error::SnapshotError;
pub use folder::Folder;
pub use format::{Contents, Snapshot};
pub use metadata::{Info, Metadata, Origin};
pub use name::Name;

/// Name of the folder that holds snapshots, beside their source files.
pub const FOLDER: &str = "snapshots";
