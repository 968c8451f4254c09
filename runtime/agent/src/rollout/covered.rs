//! Tracks the cloth's coverage during a rollout.
//!
//! In: the world's particles at the start and after each step, or, if it knows none, its pictures and one of the flat
//! cloth. Out: coverage and normalized improvement. Particles are measured by SoftGym's measure, which published
//! numbers use and which alone decides a goal, and by the true one.

use super::{Job, RunError};
use crate::record::{CoverageSource, Measures};
use crate::scene::Scene;
use fab_picture::Mask;
use fab_picture::observation::Observation;
use fab_program::Goal;
use fab_world::World;
use fab_world::metrics;

/// The measures of a rollout's start and of the current cloth.
#[derive(Debug, Default)]
pub(super) struct Covered {
    /// The measures of the start.
    pub at_start: Measures,
    pub now: Measures,
    /// What they are measured on; `None` if nothing can be measured.
    pub source: Option<CoverageSource>,
    /// The flat cloth's pixels, if pictures are compared.
    flat: Option<Mask>,
}

impl Covered {
    /// Measures the cloth at the start.
    ///
    /// Fails if the picture of the flat cloth cannot be compared with the camera's, or if the task's goal is a measure
    /// of coverage that cannot be measured here.
    pub(super) fn at_start(job: &Job<'_>, world: &mut dyn World) -> Result<Covered, RunError> {
        let mut covered = Covered::default();
        let mut seen = None;
        if world.particles().is_some() {
            covered.source = Some(CoverageSource::Particles);
        } else if let Some(flat) = world.flat_cloth() {
            let picture = world.observe()?;
            covered.flat = Some(flat_mask(job, &flat, &picture)?);
            covered.source = Some(CoverageSource::Picture);
            seen = Some(picture);
        }
        let goal = job.program.goal.as_ref();
        if let (None, Some(goal)) = (covered.source, goal)
            && goal.metric.is_judged_each_step()
        {
            return Err(RunError::Unfit(format!(
                "the task's goal is a measure of coverage, and `{}` knows neither its cloth's particles nor a picture of the flat cloth: give it one",
                world.name()
            )));
        }
        covered.update(job, world, seen.as_ref())?;
        covered.at_start = covered.now;
        covered.update(job, world, seen.as_ref())?;
        Ok(covered)
    }

    /// Measures the cloth again; improvements count from the start.
    ///
    /// - `seen`: the newest picture; `None` if nothing was done since the last measure.
    pub(super) fn update(
        &mut self,
        job: &Job<'_>,
        world: &dyn World,
        seen: Option<&Observation>,
    ) -> Result<(), RunError> {
        let grid = &job.start.grid;
        let (coverage, coverage_true) = match (self.source, seen, &self.flat) {
            (Some(CoverageSource::Particles), ..) => {
                let Some(particles) = world.particles() else {
                    self.now = Measures::default();
                    return Ok(());
                };
                let triangles = metrics::whole_triangles(grid);
                let whole_m2 = metrics::whole_area_m2(grid);
                let coverage_true = metrics::true_coverage(&particles, &triangles, whole_m2);
                (metrics::coverage(&particles, grid), coverage_true)
            }
            (Some(CoverageSource::Picture), Some(seen), Some(flat)) => {
                let now = Scene::cloth_in(job.program, seen)?;
                (now.and_then(|now| metrics::seen_coverage(&now, flat)), None)
            }
            // Nothing was done since, or nothing can be measured.
            _ => return Ok(()),
        };
        let gained = |now: Option<f64>, at_start: Option<f64>| {
            metrics::normalized_improvement(now?, at_start?)
        };
        self.now = Measures {
            coverage,
            coverage_true,
            normalized_improvement: gained(coverage, self.at_start.coverage),
            normalized_improvement_true: gained(coverage_true, self.at_start.coverage_true),
        };
        Ok(())
    }

    /// Returns whether the current cloth meets a goal that is judged after each step.
    pub(super) fn meets_goal(&self, job: &Job<'_>) -> bool {
        let goal = job.program.goal.as_ref();
        goal.is_some_and(|goal| self.now.meet(goal))
    }

    /// Returns whether a goal can be judged in this rollout.
    pub(super) fn judges(&self, goal: &Goal) -> bool {
        match self.source {
            Some(CoverageSource::Particles) => true,
            Some(CoverageSource::Picture) => goal.metric.is_judged_each_step(),
            None => false,
        }
    }
}

/// Finds the cloth in the picture of the flat one, by the task's own mask.
fn flat_mask(job: &Job<'_>, flat: &Observation, seen: &Observation) -> Result<Mask, RunError> {
    let mask = Scene::cloth_in(job.program, flat)?.filter(|mask| !mask.is_empty());
    let [is, wanted] =
        [&flat.rgb, &seen.rgb].map(|it| format!("{} x {} px", it.width(), it.height()));
    mask.filter(|_| is == wanted).ok_or_else(|| {
        RunError::Unfit(format!(
            "the picture of the flat cloth cannot be used: it has {is}, and the camera takes {wanted}; in it, the task's first \
             mask must find the cloth, alone on the table, and a picture without depth needs a mask by colour"
        ))
    })
}
