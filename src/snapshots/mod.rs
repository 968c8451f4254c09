//! Snapshot files: what prompts and pictures were when somebody last looked at them, and what they would become.
//!
//! In: a folder `snapshots/` in insta's file format. `NAME.snap` is accepted, `NAME.snap.new` is pending; a picture's
//! bytes lie beside its file as `NAME.snap.png` and `NAME.snap.new.png`.
//! Out: [`Snapshot`]s, and changes of the folder that happen whole or not at all, whenever the process is stopped.
//! What is worth a snapshot, and what to do with a pending one, is decided by those who call this.

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

/// Name of the folder that holds snapshots, beside the files that they are of.
pub const FOLDER: &str = "snapshots";
