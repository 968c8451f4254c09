//! The questions of a rollout's first step, before anything is asked: for estimates.
//!
//! In: a [`Job`]. Out: what each stage would be sent, with words in angle brackets for what only a model can say.

use super::{Job, RunError};
use crate::agent;
use crate::model::{Message, ModelRole};
use crate::pictures::Pictures;
use crate::scene::{Scene, SceneError};
use compiler::facts::Facts;
use compiler::program::Read;
use compiler::render::Values;
use compiler::reply;
use serde_json::Value;
use std::collections::BTreeMap;

/// What a stage would be sent in the first step.
#[derive(Clone, Debug)]
pub struct FirstQuestion {
    /// The stage.
    pub stage: String,
    /// Which model is asked.
    pub role: ModelRole,
    /// The messages.
    pub messages: Vec<Message>,
    /// The JSON Schema of the answer, without the values that a scene offers, where the stage reads the action.
    pub schema: Option<Value>,
    /// The longest answer, tokens, where the task states one.
    pub max_tokens: Option<u32>,
}

/// Lays the cloth, looks, and renders what each stage would be sent.
///
/// Fails where the start cannot be taken, or nothing is found in the picture.
pub fn first_questions(job: &Job<'_>) -> Result<Vec<FirstQuestion>, RunError> {
    let program = job.program;
    let mut world = (job.make_world)()?;
    world.reset(job.start)?;
    let observation = world.observe()?;
    let scene = Scene::of(program, &observation, None)?;
    let pictures = Pictures {
        subgoals: job.subgoals.step(0)?,
        annotated: scene.annotated(program, &observation.rgb, None)?,
        scene: observation.rgb,
        examples: job.examples.clone(),
    };
    let texts = BTreeMap::new();
    let question = |stage: &compiler::program::Stage| {
        let lowering = job.models.of(stage.model).lowering();
        let values = Values::Partly(Facts {
            scene: &scene,
            texts: &texts,
            step: 1,
            last: None,
            proposal: None,
            pointing: lowering.pointing(pictures.size()),
        });
        Ok(FirstQuestion {
            stage: stage.name.clone(),
            role: stage.model,
            messages: agent::conversation(program, stage, values, &pictures, 1, &lowering)?,
            schema: matches!(stage.read, Read::Action).then(|| reply::static_schema(program)),
            max_tokens: stage.max_tokens,
        })
    };
    program.stages.iter().map(question).collect()
}

impl From<SceneError> for RunError {
    fn from(error: SceneError) -> Self {
        RunError::Scene(error)
    }
}
