//! `fabc review` in a build without models and pictures: no costs and no drawings.

use super::cost::Pricing;
use super::difference::Compared;
use super::find::Pending;
use crate::exit::Failure;
use crate::io::Io;
use clap::Args;
use std::path::PathBuf;

/// Nothing: prices and pictures need the runtime.
#[derive(Args)]
pub struct ReviewShownArguments {}

impl ReviewShownArguments {
    /// Returns no folder.
    pub fn folder(&self) -> Option<PathBuf> {
        None
    }
}

/// Returns `None`: this build knows no prices.
pub fn pricing(_arguments: &ReviewShownArguments, _io: &Io) -> Result<Option<Pricing>, Failure> {
    Ok(None)
}

/// Reports that this build cannot draw.
pub fn compare(_pending: &Pending) -> Compared {
    Compared {
        png: None,
        words: "the pictures differ; this build cannot draw them".to_owned(),
        n_changed: None,
        bounds: None,
    }
}
