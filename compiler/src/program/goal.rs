//! When a task counts as reached.

use serde::{Deserialize, Serialize};

/// When a task counts as reached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// What is measured after the last step.
    pub metric: Metric,
    /// The limit, metres; reached when the measure is below it.
    pub below_m: f64,
}

/// A measure of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Mean distance between equal particles of the result and of the nearest expert result (protocol, section 6).
    ParticleDistance,
}
