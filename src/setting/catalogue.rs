//! Loads the model catalogue, and locates the user's files for it.
//!
//! In: flags and the environment. Out: a [`Catalogue`], paths, today's [`Date`]. No other part of the command knows where
//! such files are.

use crate::exit::Failure;
use fab_providers::catalogue::{Catalogue, Date, Profile};
use std::env;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// A file of the user's, and what named it.
pub struct UserFile {
    pub path: PathBuf,
    pub named_by: NamedBy,
}

/// What names a file of the user's.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum NamedBy {
    /// A flag or a variable: it has to be there.
    User,
    /// The place where such files lie: it may be missing.
    Place,
}

impl UserFile {
    /// Returns whether it is to be used: it was named, or it is there.
    pub fn counts(&self) -> bool {
        self.named_by == NamedBy::User || self.path.exists()
    }
}

/// Returns the file of facts about models: `--models`, else `FABC_MODELS`, else the one in the user's folder.
pub fn facts_file(flag: Option<&Path>) -> Option<UserFile> {
    match flag {
        Some(path) => Some(UserFile {
            path: path.to_owned(),
            named_by: NamedBy::User,
        }),
        None => user_file("FABC_MODELS", "models.toml"),
    }
}

/// Returns the file of keys: `FABC_KEYS`, else the one in the user's folder.
pub fn keys_file() -> Option<UserFile> {
    user_file("FABC_KEYS", "keys.toml")
}

fn user_file(variable: &str, name: &str) -> Option<UserFile> {
    let named = env::var_os(variable).filter(|value| !value.is_empty());
    let named = named.map(|path| UserFile {
        path: path.into(),
        named_by: NamedBy::User,
    });
    named.or_else(|| {
        dirs::config_dir().map(|folder| UserFile {
            path: folder.join("fabc").join(name),
            named_by: NamedBy::Place,
        })
    })
}

/// Returns the embedded catalogue, overlaid by the user's file.
pub fn load(flag: Option<&Path>) -> Result<Catalogue, Failure> {
    let builtin = Catalogue::builtin();
    match facts_file(flag).filter(UserFile::counts) {
        Some(file) => builtin
            .overlaid_by(&file.path)
            .map_err(Failure::environment),
        None => Ok(builtin),
    }
}

/// Returns the catalogue's entry for a model, `PROVIDER:NAME`.
pub fn profile(name: &str, models: Option<&Path>) -> Result<Profile, Failure> {
    let catalogue = load(models)?;
    let found = catalogue.find(name);
    found.map_err(|error| Failure::usage(error.to_string()))
}

/// Returns the day, in UTC.
pub fn today() -> Date {
    // A clock before 1970 is no clock to go by; its day is then the first one.
    let since = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    Date::from_unix_days(since.as_secs() / 86_400)
}
