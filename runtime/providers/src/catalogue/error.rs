//! Why facts about models cannot be used.

use super::file;

/// Why facts cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CatalogueError {
    /// The file cannot be read.
    #[error("cannot read `{file}`: {why}")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's error.
        why: String,
    },
    /// It is not TOML, or has another structure; the text names line and column.
    #[error("`{file}` holds no facts about models: {why}")]
    Shape {
        /// The file.
        file: String,
        /// The parser's error.
        why: String,
    },
    /// An entry is wrong.
    #[error("`{file}`, the entry on line {line}: {why}")]
    Entry {
        /// The file.
        file: String,
        /// Where the entry begins, from 1.
        line: usize,
        /// What is wrong, and what would be right.
        why: String,
    },
    /// A model name is not in the form PROVIDER:NAME.
    #[error("`{0}` is not a model; write PROVIDER:NAME, with a name of at most {max} bytes on one line", max = file::MAX_NAME)]
    NoModel(String),
    /// There is no such provider.
    #[error("there is no provider `{name}`{near}; there is {among}", near = meant(near.as_deref()))]
    NoProvider {
        /// The requested name.
        name: String,
        /// The one that was probably meant.
        near: Option<String>,
        /// All known providers.
        among: String,
    },
}

fn meant(near: Option<&str>) -> String {
    near.map_or(String::new(), |near| format!(" (did you mean `{near}`?)"))
}
