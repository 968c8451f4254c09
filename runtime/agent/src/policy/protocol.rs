//! The lines between `fabc` and a policy in another program.
//!
//! `docs/policies.md` documents them. Pixels are `[column, row]` of the camera's picture, lengths metres.

use fab_picture::camera::Pinhole;
use fab_program::spaces::Spaces;
use fab_program::{ActionField, Cloth, PixelPoint, Proposal, Value, space};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Version of the protocol. `hello` and `reset` came with version 2.
pub const PROTOCOL: u32 = 2;

/// What a program is asked.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Question {
    /// Which lines do you answer? A [`Hello`] answers it.
    Hello {
        /// [`PROTOCOL`].
        protocol: u32,
    },
    /// A rollout begins, or goes on after it was interrupted. An empty [`Line`] answers it, or one that refuses.
    Reset(Box<Reset>),
    /// What is to be done? A [`Line`] answers it.
    Decide(Box<Decide>),
}

/// What stays the same in a rollout.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reset {
    /// The task's name.
    pub task: String,
    /// The variant, if it is one.
    pub variant: Option<String>,
    /// The compiled task.
    pub program: PathBuf,
    /// What may be answered, and what is seen.
    pub spaces: Spaces,
    /// How many steps the task has.
    pub horizon: u32,
    /// How many answers may be rejected in a step.
    pub attempts: u32,
    /// Which of several rollouts from the same start it is.
    pub repetition: u32,
    /// The cloth, for a program that sees its particles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<Cloth>,
}

/// The state in which something is decided.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decide {
    /// The step of the task, from 1.
    pub step: u32,
    /// The action of the rollout, from 1.
    pub action: u32,
    /// What is seen.
    pub pictures: Pictures,
    /// The camera, if its lens has no distortion.
    pub camera: Option<Pinhole>,
    /// What is found in the picture, by name.
    pub keypoints: Json,
    /// What each field may be, by name.
    pub offered: BTreeMap<String, Offered>,
    /// The previous action; null in the first step.
    pub last: Option<Last>,
    /// The answers that were rejected in this step, oldest first.
    pub refusals: Vec<Refused>,
    /// Where the particles are, for a program that sees them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub particles: Option<PathBuf>,
}

/// Pictures, as files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Pictures {
    /// The camera's picture.
    pub scene: PathBuf,
    /// The same with the task's layers.
    pub annotated: PathBuf,
    /// Its depths.
    pub depth: PathBuf,
    /// The subgoal that the cloth should show now.
    pub subgoal_now: Option<PathBuf>,
    /// The subgoal after the step.
    pub subgoal_next: Option<PathBuf>,
}

/// What a field may be.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Offered {
    /// One of these.
    Values(Vec<FieldValue>),
    /// Any pixel of a mask.
    Region {
        /// The mask's name.
        any_of: String,
    },
}

/// A value of a field.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum FieldValue {
    /// A pixel.
    Pixel(PixelPoint),
    /// Anything else, as prompts write it.
    Text(String),
}

impl FieldValue {
    /// Writes a value of a field.
    pub fn of(field: &ActionField, value: &Value) -> FieldValue {
        match value {
            Value::Point(pixel) => FieldValue::Pixel(*pixel),
            other => FieldValue::Text(space::text(field, other)),
        }
    }
}

/// The values of a grip, by field.
pub type Grip = BTreeMap<String, FieldValue>;

/// Writes a proposal as a grip.
pub fn grip(actions: &[ActionField], proposal: &Proposal) -> Grip {
    let fields = actions.iter().filter_map(|field| {
        let value = proposal.get(&field.name)?;
        Some((field.name.clone(), FieldValue::of(field, value)))
    });
    fields.collect()
}

/// The previous action.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Last {
    /// What each gripper was to do.
    pub grips: Vec<Grip>,
    /// Where each really picked.
    pub picked_px: Vec<PixelPoint>,
    /// Where each placed.
    pub placed_px: Vec<PixelPoint>,
}

/// An answer that was rejected.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Refused {
    /// The grips; none if they could not be read.
    pub grips: Vec<Grip>,
    /// The check, or the field that could not be read.
    pub check: String,
    /// Why, in words.
    pub why: String,
}

/// What a program says about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub struct Hello {
    /// The version of the lines that it answers: [`PROTOCOL`].
    pub protocol: u32,
}

/// A program's answer: at most one of the two fields.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// What each gripper is to do. Fields are read one by one, so that a message can name the wrong one.
    pub grips: Option<Vec<Map<String, Json>>>,
    /// Why nothing further is proposed.
    pub refuse: Option<String>,
}
