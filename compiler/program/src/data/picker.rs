//! How the cloth is picked, carried and released.

use crate::words::words;
use serde::{Deserialize, Serialize};

/// The two pickers of the paper's environments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Picker {
    /// Carries the cloth low and puts it down (Foldsformer's environment, for folding).
    #[default]
    PutDown,
    /// Carries the cloth and drops it from there (SoftGym's environment, for smoothing).
    Drop,
}

words! { Picker {
    "put_down" => PutDown, "carries the cloth low and puts it down before it lets go";
    "drop" => Drop, "carries the cloth and lets it fall from there";
} }
