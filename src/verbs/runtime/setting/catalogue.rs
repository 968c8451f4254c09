//! Loads the model catalogue, and locates the user's files for it.
//!
//! In: flags and the environment. Out: a [`Catalogue`], paths, today's [`Date`]. No other part of the command knows where
//! such files are.

use crate::exit::Failure;
use crate::io::Io;
use clap::{Args, ValueHint};
use fab_providers::catalogue::{Catalogue, Date};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

/// Where facts about models are looked up.
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct FactsArguments {
    /// Your own facts about models, which override the embedded ones; default: FABC_MODELS, or `fabc/models.toml` in your folder of settings.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub models: Option<PathBuf>,
}

/// A user's file.
pub struct UserFile {
    pub path: PathBuf,
    /// Whether a flag or a variable names it, so that it must exist; the default path may be missing.
    pub is_named: bool,
}

impl UserFile {
    /// Returns whether to use it: it was named explicitly, or it exists.
    pub fn counts(&self) -> bool {
        self.is_named || self.path.exists()
    }
}

/// Returns the file of model facts: `--models`, else `FABC_MODELS`, else the one in the user's folder.
pub fn facts_file(flag: Option<&Path>, io: &Io) -> Option<UserFile> {
    user_file(flag, "FABC_MODELS", "models.toml", io)
}

/// Returns the file of keys: `FABC_KEYS`, else the one in the user's folder.
pub fn keys_file(io: &Io) -> Option<UserFile> {
    user_file(None, "FABC_KEYS", "keys.toml", io)
}

fn user_file(flag: Option<&Path>, variable: &str, name: &str, io: &Io) -> Option<UserFile> {
    let variable = io.variable(variable).filter(|value| !value.is_empty());
    let named = flag.map(Path::to_owned).or(variable.map(PathBuf::from));
    let is_named = named.is_some();
    let path = named.or_else(|| Some(dirs::config_dir()?.join("fabc").join(name)))?;
    Some(UserFile { path, is_named })
}

/// Returns the embedded catalogue, overlaid by the user's file.
pub fn load(flag: Option<&Path>, io: &Io) -> Result<Catalogue, Failure> {
    let builtin = Catalogue::builtin();
    match facts_file(flag, io).filter(UserFile::counts) {
        Some(file) => builtin
            .overlaid_by(&file.path)
            .map_err(Failure::environment),
        None => Ok(builtin),
    }
}

/// Returns the day, in UTC.
pub fn today(io: &Io) -> Date {
    // A clock before 1970 is wrong; use 1970-01-01 then.
    let since = io.now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Date::from_unix_days(since.as_secs() / 86_400)
}
