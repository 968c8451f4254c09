//! A file that is to be written.

/// A file that is to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Artifact {
    /// Where it belongs, relative to the folder that is built into; `/` as separator.
    pub path: String,
    /// What it holds.
    pub text: String,
}
