//! The compiler's only access to the outside: it asks for texts by name.

/// Gives the compiler texts, its only access to the outside.
pub trait Loader {
    /// Returns the text of a file.
    ///
    /// `name` is the entry as the caller of [`compile`](crate::compile) named it, or the path of a `use`, resolved
    /// relative to the file that contains it: `/` between folders, no `.`, and `..` only at the front.
    fn load(&self, name: &str) -> Result<String, LoadError>;
}

/// Why a file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadError {
    /// The reason, naming the file: lower case, no full stop.
    pub message: String,
}

impl std::fmt::Display for LoadError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for LoadError {}
