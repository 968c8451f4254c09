//! How the cloth is picked, carried and released.

use serde::{Deserialize, Serialize};

/// The two ways of the paper's environments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Picker {
    /// Carries the cloth low and puts it down (Foldsformer's environment, for folding).
    #[default]
    PutDown,
    /// Carries the cloth and lets it fall from there (SoftGym's environment, for smoothing).
    Drop,
}

impl Picker {
    /// Every way, with the name that a task gives it.
    pub const NAMES: [(&'static str, Picker); 2] =
        [("put_down", Picker::PutDown), ("drop", Picker::Drop)];
}
