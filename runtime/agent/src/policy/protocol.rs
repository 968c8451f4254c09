//! The lines between `fabc` and a policy in another program.
//!
//! `docs/policies.md` documents every key. Pixels are `[column, row]` of the camera's picture, lengths metres.

use fab_picture::camera::Pinhole;
use fab_program::spaces::Spaces;
use fab_program::{ActionField, Cloth, PixelPoint, Proposal, Value, space};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Version of the protocol. `hello` and `reset` came with version 2.
pub const PROTOCOL: u32 = 2;

/// What a program is asked.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Question {
    /// Which lines do you answer? A [`Hello`] answers it.
    Hello { protocol: u32 },
    /// A rollout begins, or goes on after it was interrupted. [`Ready`] answers it.
    Reset(Box<Reset>),
    /// What is to be done? An [`Answer`] answers it.
    Decide(Box<Decide>),
}

/// What stays the same in a rollout.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reset {
    pub task: String,
    pub variant: Option<String>,
    pub program: PathBuf,
    pub spaces: Spaces,
    pub horizon: u32,
    pub attempts: u32,
    pub repetition: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<Cloth>,
}

/// The state in which something is decided.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decide {
    pub step: u32,
    pub action: u32,
    pub pictures: Pictures,
    pub camera: Option<Pinhole>,
    pub keypoints: Json,
    pub offered: BTreeMap<String, Offered>,
    pub last: Option<Last>,
    pub refusals: Vec<Refused>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub particles: Option<PathBuf>,
}

/// Pictures, as files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Pictures {
    pub scene: PathBuf,
    pub annotated: PathBuf,
    pub depth: PathBuf,
    pub subgoal_now: Option<PathBuf>,
    pub subgoal_next: Option<PathBuf>,
}

/// What a field may be.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Offered {
    Values(Vec<FieldValue>),
    Region { any_of: String },
}

/// A value of a field.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a value is a pixel, `[column, row]`, or a text")]
pub enum FieldValue {
    Pixel(PixelPoint),
    /// Anything else, as prompts write it.
    Text(String),
}

impl FieldValue {
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
    pub grips: Vec<Grip>,
    pub picked_px: Vec<PixelPoint>,
    pub placed_px: Vec<PixelPoint>,
}

/// An answer that was rejected.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Refused {
    pub grips: Vec<Grip>,
    pub check: String,
    pub why: String,
}

/// What a program says about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub struct Hello {
    pub protocol: u32,
}

/// A program's answer to [`Question::Reset`].
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ready {
    /// Why the task cannot be done, if so.
    pub refuse: Option<String>,
}

/// A program's answer to [`Question::Decide`]: one of the two keys.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// What each gripper is to do; current worlds have one.
    Grips([Grip; 1]),
    /// Why nothing is to be done.
    Refuse(String),
}
