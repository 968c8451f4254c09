//! How much of the table the cloth covers while a rollout runs, by two measures.
//!
//! In: the world's particles at the start and after each step. Out: coverage and normalized improvement, by
//! SoftGym's measure, which published numbers use and which alone decides a goal, and by the true one.

use super::Job;
use crate::metrics;
use crate::world::World;
use compiler::program::Metric;
use serde::Serialize;

/// How much the cloth covers at one moment (protocol, section 5); null where the world does not know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measures {
    /// Covered share of the flat cloth's area, as SoftGym measures both: the source measure.
    pub coverage: Option<f64>,
    /// The same, measured truly.
    pub coverage_true: Option<f64>,
    /// Share of the coverage missing at first that was gained, by the source measure.
    pub normalized_improvement: Option<f64>,
    /// The same, measured truly.
    pub normalized_improvement_true: Option<f64>,
}

/// The measures of a rollout's start and of the cloth as it lies now.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Covered {
    /// Measured as the cloth lay at first.
    pub at_start: Measures,
    pub now: Measures,
}

impl Covered {
    /// Measures the cloth as it lies at first.
    pub(super) fn at_start(job: &Job<'_>, world: &dyn World) -> Covered {
        let mut covered = Covered::default();
        covered.at_start = covered.measured(job, world);
        covered.update(job, world);
        covered
    }

    /// Measures the cloth again; improvements count from the start.
    pub(super) fn update(&mut self, job: &Job<'_>, world: &dyn World) {
        self.now = self.measured(job, world);
    }

    /// Returns whether a goal that is judged after each step is reached as the cloth lies now.
    pub(super) fn meets_goal(&self, job: &Job<'_>) -> bool {
        let Some(goal) = &job.program.goal else {
            return false;
        };
        let value = match goal.metric {
            Metric::Coverage => self.now.coverage,
            Metric::NormalizedImprovement => self.now.normalized_improvement,
            Metric::ParticleDistance => None,
        };
        value.is_some_and(|value| goal.is_met(value))
    }

    fn measured(&self, job: &Job<'_>, world: &dyn World) -> Measures {
        let Some(particles) = world.particles() else {
            return Measures::default();
        };
        let grid = &job.start.grid;
        let coverage = metrics::coverage(&particles, grid);
        let coverage_true = metrics::true_coverage(
            &particles,
            &metrics::whole_triangles(grid),
            metrics::whole_area_m2(grid),
        );
        let gained = |now: Option<f64>, at_start: Option<f64>| {
            metrics::normalized_improvement(now?, at_start?)
        };
        Measures {
            coverage,
            coverage_true,
            normalized_improvement: gained(coverage, self.at_start.coverage),
            normalized_improvement_true: gained(coverage_true, self.at_start.coverage_true),
        }
    }
}
