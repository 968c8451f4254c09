//! The questions of a rollout's first step, before anything is asked: for estimates.
//!
//! In: a [`Job`]. Out: the first question of each stage, with words in angle brackets for texts that only a model can
//! give.

use super::{Job, RunError};
use crate::pictures::Pictures;
use crate::policy;
use crate::scene::Scene;
use fab_model::{Models, Request};
use fab_program::Read;
use fab_program::facts::Facts;
use fab_program::render::Values;
use fab_program::reply;
use fab_world::WorldPoint;

/// The first question of a stage.
#[derive(Clone, Debug)]
pub struct FirstQuestion {
    /// The stage.
    pub stage: String,
    /// The question; if the stage reads the action, its schema lacks the scene's values.
    pub request: Request,
}

/// Lays the cloth, observes it, and renders the first question of each stage.
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
    let question = |stage: &fab_program::Stage| {
        let lowering = models.of(stage.model).lowering();
        let facts = Facts::of(&scene, 1, lowering.pointing(pictures.size()));
        let values = Values::Partly(facts);
        let asked = policy::conversation(program, stage, values, &pictures, 1, &lowering)?;
        let schema = match &stage.read {
            Read::Text { before, .. } => reply::text_schema(before),
            Read::Action => reply::static_schema(program),
        };
        Ok(FirstQuestion {
            stage: stage.name.clone(),
            request: policy::request(stage, &asked, schema),
        })
    };
    program.stages.iter().map(question).collect()
}
