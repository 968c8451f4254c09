//! The compiler's only access to the outside: it asks for texts by name, and for what lies where a task names a file.

use fab_program::{Material, Trial};

/// Gives the compiler texts, its only access to the outside.
pub trait Loader {
    /// Returns the text of a file.
    ///
    /// `name` is the entry as the caller of [`compile`](crate::compile) named it, or the path of a `use`, resolved
    /// relative to the file that contains it: `/` between folders, no `.`, and `..` only at the front.
    fn load(&self, name: &str) -> Result<String, LoadError>;

    /// Returns what lies where a task names a start, a picture or demonstrations.
    ///
    /// `path` is relative to the entry's folder, `/` between folders, and never leads out of it. Without a listing, the
    /// files are not checked: a task may be compiled where they are not. A file that is not what it is wanted for has
    /// [`Listed::Nothing`] to read.
    fn look(&self, _path: &str, _wanted: Wanted) -> Listed {
        Listed::Unknown
    }

    /// Returns what the steps of a task's demonstration did to the cloth when it was last executed, if that is known.
    ///
    /// `title` is the task's, or `task/variant`. A result of another demonstration is not used.
    fn trial(&self, _title: &str) -> Option<Trial> {
        None
    }

    /// Returns why the caller's simulator cannot lay a cloth of this material with particles this far apart; `None` if it can,
    /// or if there is no simulator. Lower case, no full stop.
    fn refuses_cloth(&self, _material: &Material, _spacing_m: f64) -> Option<String> {
        None
    }
}

/// What a file that a task names must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Wanted {
    /// A PNG or JPEG picture as large as the camera's, because arrows and points are given in its pixels.
    CameraPicture,
    /// A PNG or JPEG picture of any size.
    Picture,
    /// Particle positions, `.npy` of shape `[particles, 3]` or `[particles, 4]`.
    Positions,
    /// Demonstrations, a JSON object in each line.
    Demonstrations,
}

/// What lies where a task names a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Listed {
    /// The caller has no listing.
    Unknown,
    /// No file that can be read as what it is wanted for; the reason, lower case, no full stop.
    Nothing(String),
    /// A picture.
    Picture {
        /// Its width, pixels.
        width: u32,
        /// Its height, pixels.
        height: u32,
    },
    /// A file that is not a picture.
    Other,
}

/// Why a file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct LoadError {
    /// The reason, naming the file: lower case, no full stop.
    pub message: String,
}
