//! A compiled task: plain, versioned data that a runtime executes.
//!
//! Only the compiler makes programs, so their references are valid. The bytes of the JSON depend only on the source
//! text. Quantities are in base units (metres, pixels, radians). Pixels are those of the task's camera picture,
//! `[column, row]`, origin top left.

use super::actions::ActionField;
use super::annotate::Layer;
use super::camera::Camera;
use super::cloth::Cloth;
use super::demos::Demos;
use super::files::SourceStamp;
use super::folds::Sequence;
use super::goal::Goal;
use super::keypoints::Keypoint;
use super::manner::Manner;
use super::picker::Picker;
use super::rehearse::Rehearsal;
use super::stage::{Reasoning, Stage, Template};
use super::subgoals::Subgoals;
use super::uses::Depends;
use super::verify::Verify;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use sha2::{Digest, Sha256};

/// Version of the format of [`Program`]. A program of another version is refused: it has to be compiled again.
pub const PROGRAM_FORMAT: u32 = 9;

/// Everything a rollout needs to know about one task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// The version of the format, always [`PROGRAM_FORMAT`].
    #[serde(deserialize_with = "this_format")]
    pub format: u32,
    /// Version of the compiler, e.g. `0.1.0`.
    pub compiler: String,
    /// The task's name as written in the file.
    pub task: String,
    /// Which variant of the task this is; `None` for the task itself.
    pub variant: Option<String>,
    /// What the task is for, in its author's words; no model sees it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<String>,
    /// The source files, in the order in which they were first read.
    pub sources: Vec<SourceStamp>,
    /// The cloth of the task.
    pub cloth: Cloth,
    /// The camera in whose pixels every point is given.
    pub camera: Camera,
    /// How the cloth is picked, carried and released.
    pub picker: Picker,
    /// How the gripper goes about every pick and place, where the task states it; an action's own fields come first.
    #[serde(default, skip_serializing_if = "Manner::is_default")]
    pub manner: Manner,
    /// The pictures that show what to do, step by step, if the task has any.
    pub subgoals: Option<Subgoals>,
    /// Fold sequences that count as right; the score is the distance to the nearest of their results.
    pub experts: Vec<Sequence>,
    /// What is found in each observation, in declaration order; an extractor uses only earlier ones.
    pub keypoints: Vec<Keypoint>,
    /// What is drawn on the camera's picture, in order.
    pub layers: Vec<Layer>,
    /// The discretised action space, one entry per field of an answer.
    pub actions: Vec<ActionField>,
    /// Every piece of text that can reach a model, by name.
    pub templates: Vec<Template>,
    /// The questions that make up one step, in order; the last one reads the action.
    pub stages: Vec<Stage>,
    /// The in-context examples of one stage, if the task names any.
    pub demos: Option<Demos>,
    /// The checks that a proposed action must pass.
    pub verify: Verify,
    /// The most actions in one rollout.
    pub horizon: u32,
    /// When the task counts as reached; without one, a rollout ends at its horizon.
    pub goal: Option<Goal>,
    /// How the answers of a stage are tried on a twin before the world moves, if they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rehearsal: Option<Rehearsal>,
}

impl Program {
    /// Returns the program's identity: the first 16 hex digits of the SHA-256 of its compact JSON. It leaves out what
    /// does not affect a rollout: the sources, the lines in them, and the [`Program::notes`].
    pub fn hash(&self) -> String {
        let bytes = serde_json::to_vec(&self.without_notes())
            .expect("a program has string keys and finite numbers");
        hex(&Sha256::digest(bytes))[..16].to_owned()
    }

    /// Returns the task's notes for readers, each with its name; no model sees them.
    pub fn notes(&self) -> Vec<(&'static str, &str)> {
        let notes = [("about", self.about.as_deref())].into_iter();
        notes
            .filter_map(|(name, note)| Some((name, note?)))
            .collect()
    }

    fn without_notes(&self) -> Program {
        let mut program = Program {
            about: None,
            sources: Vec::new(),
            ..self.clone()
        };
        let twin = program.rehearsal.as_mut();
        let twin = twin.and_then(|it| it.twin.material.as_mut());
        for material in program.cloth.material.iter_mut().chain(twin) {
            material.sources.clear();
        }
        for template in &mut program.templates {
            (template.declared_in, template.line) = (String::new(), 0);
        }
        let examples = program.stages.iter_mut().flat_map(|it| &mut it.examples);
        for text in examples.flat_map(|it| it.say.iter_mut().chain([&mut it.reply])) {
            (text.declared_in, text.line) = (String::new(), 0);
        }
        program
    }

    /// Returns whether another program runs as this one does: they differ at most in notes and in their variant's name.
    pub fn runs_as(&self, other: &Program) -> bool {
        let [own, other] = [self, other].map(|program| Program {
            variant: None,
            ..program.without_notes()
        });
        own == other
    }

    /// Returns the program with this `reasoning` in every stage; `None` leaves what they state.
    pub fn with_reasoning(mut self, reasoning: Option<Reasoning>) -> Program {
        for stage in &mut self.stages {
            stage.reasoning = reasoning.or(stage.reasoning);
        }
        self
    }

    /// Returns the template of that name.
    ///
    /// The compiler only emits names that exist, so `None` means a program edited by hand.
    pub fn template(&self, name: &str) -> Option<&Template> {
        self.templates.iter().find(|template| template.name == name)
    }

    /// Returns the keypoint of that name.
    pub fn keypoint(&self, name: &str) -> Option<&Keypoint> {
        self.keypoints.iter().find(|keypoint| keypoint.name == name)
    }

    /// Returns the field of that name.
    pub fn field(&self, name: &str) -> Option<&ActionField> {
        self.actions.iter().find(|field| field.name == name)
    }

    /// Returns the task's name, followed by a slash and the variant's name if there is one.
    pub fn title(&self) -> String {
        match &self.variant {
            Some(variant) => format!("{}/{variant}", self.task),
            None => self.task.clone(),
        }
    }

    /// Returns whether a question or its picture says something about the previous action, so the first step does not
    /// show all of it.
    pub fn looks_back(&self) -> bool {
        let stages = self.stages.iter();
        let mut said = stages.flat_map(|stage| stage.system.iter().chain(&stage.say));
        let mut guards = said
            .by_ref()
            .filter_map(|name| self.template(name)?.when.as_ref());
        guards.any(|guard| guard.uses().history) || self.layers.iter().any(Layer::uses_last)
    }

    /// Returns the largest number of model calls in one step: every stage, with all its attempts, for each action of
    /// the step. A stage that is rehearsed has its attempts for each candidate, and one call for each revision.
    pub fn calls_per_step(&self) -> u32 {
        let attempts = self.verify.attempts;
        let calls = self
            .stages
            .iter()
            .map(|stage| match self.rehearsal_of(stage) {
                Some(rehearsal) => {
                    let candidates = rehearsal.choose.map_or(1, |_| stage.candidates());
                    candidates * attempts + rehearsal.revisions
                }
                None => attempts,
            });
        calls.sum::<u32>() * self.actions_per_step()
    }

    /// Returns how the answers of a stage are rehearsed, if they are.
    pub fn rehearsal_of(&self, stage: &Stage) -> Option<&Rehearsal> {
        let rehearsal = self.rehearsal.as_ref();
        rehearsal.filter(|it| it.stage == stage.name)
    }

    /// Returns the largest number of actions in one step: more than one if a step is retried.
    pub fn actions_per_step(&self) -> u32 {
        let retries = self.verify.result.as_ref();
        1 + retries.map_or(0, |result| result.retries)
    }
}

/// Reads the version of a program; fails for any other than this one.
fn this_format<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    match u32::deserialize(deserializer)? {
        PROGRAM_FORMAT => Ok(PROGRAM_FORMAT),
        other => Err(D::Error::custom(format!(
            "the program has format {other}, and this version reads format {PROGRAM_FORMAT}; compile the task again"
        ))),
    }
}

/// Writes bytes as lower-case hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
