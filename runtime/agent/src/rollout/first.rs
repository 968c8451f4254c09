//! The questions of a rollout's first step, before anything is asked: for estimates.

use super::{Job, RunError};
use crate::pictures::Pictures;
use crate::policy::{self, FirstQuestion, StepView};
use crate::scene::Scene;
use fab_model::Models;
use fab_world::WorldPoint;

/// Lays the cloth, observes it, and writes the first question of each stage.
///
/// Fails if the world cannot take the start, or nothing is found in the picture.
pub fn first_questions(job: &Job<'_>, models: Models<'_>) -> Result<Vec<FirstQuestion>, RunError> {
    let program = job.program;
    let mut world = (job.make_world)()?;
    world.reset(job.start)?;
    let observation = world.observe()?;
    let reach = |point: &WorldPoint| world.out_of_reach(point);
    let scene = Scene::of(program, &observation, None)?;
    let scene = scene.within_reach(program, &observation, &reach)?;
    let subgoals = job.subgoals.step(0)?;
    let examples = job.examples.clone();
    let pictures = Pictures::of(program, &scene, &observation, None, subgoals, examples)?;
    let view = StepView::without_rollout(program, &scene, &observation, 1, None, &pictures);
    policy::first_questions(view, models)
}
