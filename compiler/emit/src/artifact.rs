//! A file to write.

/// A file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Artifact {
    /// Its path, relative to the output folder; `/` as separator.
    pub path: String,
    /// Its contents.
    pub text: String,
}
