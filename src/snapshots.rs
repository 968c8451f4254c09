//! Snapshot files: prompts and pictures as the user last accepted them, and proposed new versions.
//!
//! In: a folder `snapshots/` in insta's file format. `NAME.snap` is accepted, `NAME.snap.new` is pending; a picture's
//! bytes lie beside its file as `NAME.snap.png` and `NAME.snap.new.png`.
//! Out: [`Snapshot`]s, and changes of the folder, one file after the other, each by one rename. A process that is killed
//! in between leaves some snapshots changed and others not, which the next run goes on from.
//! Callers decide which snapshots to make and what to do with pending ones.

mod folder;
mod format;

#[cfg(test)]
mod tests;

pub use folder::{Folder, Side, picture_of};
pub use format::{Contents, Info, Origin, Snapshot};

/// Name of the folder that holds snapshots, beside their source files.
pub const FOLDER: &str = "snapshots";

/// The name of a snapshot, such as `double_straight.describe@start`; also its file's name without the extension.
pub type Name = String;

/// Returns whether `fabc` gives such names: they contain the scene after an `@`.
pub fn is_ours(name: &str) -> bool {
    name.contains('@')
}
