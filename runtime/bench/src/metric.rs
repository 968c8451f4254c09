//! What a suite measures.
//!
//! Smoothing is measured twice (protocol, section 5): by SoftGym's grid, whose numbers the paper prints and
//! which decides when a rollout stops, and by the true area. A value with the stop is the one at the first step
//! that met the goal, frozen from there; a value without is that of a rollout which went on. Measures by pictures, of a cloth
//! whose particles nobody knows, have metrics of their own: a rollout has values for the one kind or for the other.

use fab_agent::rollout::CoverageSource;
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
    /// Normalized improvement by pictures, with the early stop.
    NormalizedImprovementPicture,
    /// Whether the cloth covers at least [`COVERED`] in the end by SoftGym's grid; its statistic is always the share.
    #[serde(rename = "covered_0.85_source")]
    CoveredSource,
    /// Likewise by pictures.
    #[serde(rename = "covered_0.85_picture")]
    CoveredPicture,
    /// Whether the goal was reached, of the rollouts for which that is known; its statistic is always the share.
    GoalReached,
    /// Whether the operator says that the task was reached, of the rollouts that were judged; always the share.
    ReachedByOperator,
}

/// The coverage from which on the paper counts a cloth on the real table as smooth.
pub const COVERED: f64 = 0.85;

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
            Metric::NormalizedImprovementPicture => "normalized_improvement_picture",
            Metric::CoveredSource => "covered_0.85_source",
            Metric::CoveredPicture => "covered_0.85_picture",
            Metric::GoalReached => "goal_reached",
            Metric::ReachedByOperator => "reached_by_operator",
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
            Metric::NormalizedImprovementPicture => "NI, picture",
            Metric::CoveredSource => "covers 0.85, source",
            Metric::CoveredPicture => "covers 0.85, picture",
            Metric::GoalReached => "goal reached",
            Metric::ReachedByOperator => "reached, by the operator",
        }
    }

    /// Returns how many digits behind the point are worth printing.
    pub fn digits(self) -> usize {
        match self {
            Metric::MeanParticleDistanceMm | Metric::MeanParticleDistanceMmGamma09 => 1,
            _ if self.is_share() => 2,
            _ => 3,
        }
    }

    /// Returns whether it says of a rollout that something happened or not, so that its statistic is the share.
    pub fn is_share(self) -> bool {
        matches!(
            self,
            Metric::CoveredSource
                | Metric::CoveredPicture
                | Metric::GoalReached
                | Metric::ReachedByOperator
        )
    }

    /// Returns what coverage must have been measured on for a rollout to have a value; none where that does not matter.
    pub fn source(self) -> Option<CoverageSource> {
        match self {
            Metric::NormalizedImprovementSource
            | Metric::NormalizedImprovementTrue
            | Metric::NormalizedImprovementSourceWithoutStop
            | Metric::NormalizedImprovementTrueWithoutStop
            | Metric::CoveredSource => Some(CoverageSource::Particles),
            Metric::NormalizedImprovementPicture | Metric::CoveredPicture => {
                Some(CoverageSource::Picture)
            }
            _ => None,
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

    /// Returns whether nothing can be said of it where nobody knows the cloth's particles.
    pub fn needs_particles(self) -> bool {
        self.source() == Some(CoverageSource::Particles) || self.fold_fraction().is_some()
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
            Metric::NormalizedImprovementPicture,
            Metric::CoveredSource,
            Metric::CoveredPicture,
            Metric::GoalReached,
            Metric::ReachedByOperator,
        ] {
            assert_eq!(
                serde_json::json!(metric),
                serde_json::json!(metric.as_str())
            );
        }
    }
}
