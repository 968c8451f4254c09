//! When a task counts as reached.

use crate::data::values::Comparison;
use serde::{Deserialize, Serialize};

/// When a task counts as reached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// What is measured.
    pub metric: Metric,
    /// How it must compare with the limit.
    pub is: Comparison,
    /// Metres for a distance, otherwise a fraction.
    pub limit: f64,
}

impl Goal {
    /// Returns whether a measured value reaches the goal.
    pub fn is_met(&self, value: f64) -> bool {
        self.is.holds(value, self.limit)
    }
}

/// A measure of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Mean distance between corresponding particles of the result and of the nearest expert result, metres, after
    /// the last step (protocol, section 6).
    ParticleDistance,
    /// Covered area divided by the area of the flat cloth, after each step (protocol, section 5).
    Coverage,
    /// Which part of the coverage missing at the start has been gained, after each step (protocol, section 5).
    NormalizedImprovement,
}

impl Metric {
    /// Returns its name in a task and in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Metric::ParticleDistance => "particle_distance",
            Metric::Coverage => "coverage",
            Metric::NormalizedImprovement => "normalized_improvement",
        }
    }

    /// Returns whether it is judged after every step, so a rollout may end early.
    pub fn is_judged_each_step(self) -> bool {
        !matches!(self, Metric::ParticleDistance)
    }
}
