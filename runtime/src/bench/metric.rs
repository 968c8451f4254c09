//! What a suite measures.
//!
//! Smoothing is measured twice (protocol, section 5): by SoftGym's grid, whose numbers the paper prints and
//! which decides when a rollout stops, and by the true area. A value with the stop is the one at the first step
//! that met the goal, frozen from there; a value without is that of a rollout which went on.

use serde::{Deserialize, Serialize};

/// A measure of a rollout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Mean particle distance to the nearest expert end whose folds go the whole way, millimetres.
    MeanParticleDistanceMm,
    /// Likewise, with every fold of the experts ending at 0.9 of its way, as the recorded demonstrations do.
    #[serde(rename = "mean_particle_distance_mm_gamma_0.9")]
    MeanParticleDistanceMmGamma09,
    /// Normalized improvement by SoftGym's grid, with the early stop.
    NormalizedImprovementSource,
    /// Normalized improvement by the true area, with the early stop.
    NormalizedImprovementTrue,
    /// Normalized improvement by SoftGym's grid, of a rollout that does not stop early.
    NormalizedImprovementSourceWithoutStop,
    /// Normalized improvement by the true area, of a rollout that does not stop early.
    NormalizedImprovementTrueWithoutStop,
    /// Whether the goal was reached; its statistic is always the share.
    GoalReached,
}

impl Metric {
    /// Returns its name in suites, JSON and CSV.
    pub fn as_str(self) -> &'static str {
        match self {
            Metric::MeanParticleDistanceMm => "mean_particle_distance_mm",
            Metric::MeanParticleDistanceMmGamma09 => "mean_particle_distance_mm_gamma_0.9",
            Metric::NormalizedImprovementSource => "normalized_improvement_source",
            Metric::NormalizedImprovementTrue => "normalized_improvement_true",
            Metric::NormalizedImprovementSourceWithoutStop => {
                "normalized_improvement_source_without_stop"
            }
            Metric::NormalizedImprovementTrueWithoutStop => {
                "normalized_improvement_true_without_stop"
            }
            Metric::GoalReached => "goal_reached",
        }
    }

    /// Returns the head of its column in tables for people.
    pub fn heading(self) -> &'static str {
        match self {
            Metric::MeanParticleDistanceMm => "distance, mm",
            Metric::MeanParticleDistanceMmGamma09 => "to gamma 0.9, mm",
            Metric::NormalizedImprovementSource => "NI, source",
            Metric::NormalizedImprovementTrue => "NI, true",
            Metric::NormalizedImprovementSourceWithoutStop => "source, no stop",
            Metric::NormalizedImprovementTrueWithoutStop => "true, no stop",
            Metric::GoalReached => "goal reached",
        }
    }

    /// Returns how many digits behind the point are worth printing.
    pub fn digits(self) -> usize {
        match self {
            Metric::MeanParticleDistanceMm | Metric::MeanParticleDistanceMmGamma09 => 1,
            Metric::GoalReached => 2,
            _ => 3,
        }
    }

    /// Returns the share of its way at which each fold of the experts ends, where experts are what counts.
    pub fn fold_fraction(self) -> Option<f64> {
        match self {
            Metric::MeanParticleDistanceMm => Some(1.0),
            Metric::MeanParticleDistanceMmGamma09 => Some(0.9),
            _ => None,
        }
    }

    /// Returns whether it needs a rollout that goes on after its goal was met.
    pub fn is_without_stop(self) -> bool {
        matches!(
            self,
            Metric::NormalizedImprovementSourceWithoutStop
                | Metric::NormalizedImprovementTrueWithoutStop
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_equal_the_serialised_form() {
        for metric in [
            Metric::MeanParticleDistanceMm,
            Metric::MeanParticleDistanceMmGamma09,
            Metric::NormalizedImprovementSource,
            Metric::NormalizedImprovementTrue,
            Metric::NormalizedImprovementSourceWithoutStop,
            Metric::NormalizedImprovementTrueWithoutStop,
            Metric::GoalReached,
        ] {
            assert_eq!(
                serde_json::json!(metric),
                serde_json::json!(metric.as_str())
            );
        }
    }
}
