//! The lines between `fabc` and a world in another program: one set of types for both sides.
//!
//! `docs/worlds.md` documents them. Lengths are metres in the world frame, times seconds.

use crate::Grip;
use crate::start::Grid;
use fab_picture::camera::Pinhole;
use fab_program::{Camera, Material, Picker};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Version of the protocol. An action has `grips` since version 2.
pub const PROTOCOL: u32 = 2;

/// The questions that have an answer, and the default limit for each, seconds.
pub const LIMITS_S: [(&str, u64); 7] = [
    ("hello", 60),
    ("observe", 60),
    ("particles", 60),
    ("reach", 60),
    ("reset", 600),
    ("act", 600),
    ("crumple", 600),
];

/// A question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Question {
    /// What are you?
    Hello {
        /// [`PROTOCOL`].
        protocol: u32,
        /// A folder for exchanged files, removed at the end.
        folder: PathBuf,
    },
    /// Lay a cloth.
    Reset {
        /// The camera of the pictures.
        camera: Camera,
        /// How the cloth is released.
        picker: Picker,
        /// How the cloth lies.
        start: ClothState,
    },
    /// Take a picture.
    Observe,
    /// Execute a motion; an [`Executed`](crate::Executed) answers it.
    Act {
        /// What each gripper does.
        grips: Vec<Grip>,
    },
    /// Stop the current action; has no answer of its own.
    Interrupt,
    /// Where are the particles?
    Particles,
    /// Crumple a cloth at random, and return how it then lies.
    Crumple {
        /// Decides everything random.
        seed: u64,
        /// The cloth.
        start: ClothState,
    },
    /// Can something be done at a point?
    Reach {
        /// The point.
        point: [f64; 3],
    },
}

impl Question {
    /// Returns its name in a line.
    pub fn name(&self) -> &'static str {
        match self {
            Question::Hello { .. } => "hello",
            Question::Reset { .. } => "reset",
            Question::Observe => "observe",
            Question::Act { .. } => "act",
            Question::Interrupt => "interrupt",
            Question::Particles => "particles",
            Question::Crumple { .. } => "crumple",
            Question::Reach { .. } => "reach",
        }
    }
}

/// How a cloth lies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClothState {
    /// Its name in reports.
    pub name: String,
    /// Its arrangement.
    pub lie: Arrangement,
    /// Its particle grid.
    pub grid: Grid,
    /// Its particles: a `.npy` file of float32, shape `[dimy * dimx, 3]`.
    pub positions: PathBuf,
    /// What it is made of, if the task says so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
}

/// The arrangement of a cloth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// Flat on the table's centre, edges along the axes.
    Flat,
    /// As its positions say.
    Positions,
}

/// What a world reports about itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// The version of the lines that it answers: [`PROTOCOL`]. Version 1 had no such key.
    #[serde(default = "one")]
    pub protocol: u32,
    /// Its name in reports.
    pub name: String,
    /// A hash of every setting that changes results.
    pub parameters: String,
    /// A hash of its code.
    pub code: String,
    /// How many grippers move at the same time.
    #[serde(default = "one")]
    pub grippers: u32,
    /// Whether it knows where each particle is.
    #[serde(default)]
    pub particles: bool,
    /// Whether it answers [`Question::Crumple`].
    #[serde(default)]
    pub crumples: bool,
    /// Whether it answers [`Question::Reach`].
    #[serde(default)]
    pub reach: bool,
    /// The fields of an action's manner that it acts on, such as `lift`.
    #[serde(default)]
    pub acts_on: Vec<String>,
    /// Whether a cloth can be of the material that a start states; a task with a material needs such a world.
    #[serde(default)]
    pub materials: bool,
    /// Whether equal starts and actions give equal results.
    #[serde(default = "yes")]
    pub repeats: bool,
    /// Its own time limits, seconds, by the question's name.
    #[serde(default)]
    pub limits_s: BTreeMap<String, u64>,
}

fn one() -> u32 {
    1
}

fn yes() -> bool {
    true
}

/// Done, with nothing to report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Nothing {}

/// What the camera sees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraView {
    /// Colour, a PNG file.
    pub rgb: PathBuf,
    /// Depth along the optical axis, a `.npy` file of float32, shape `[height, width]`; 0 means no reading.
    pub depth: PathBuf,
    /// Time since the reset.
    pub time_s: f64,
    /// The camera that took it.
    pub camera: Pinhole,
}

/// Where the particles are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Positions {
    /// A `.npy` file of float32, shape `[dimy * dimx, 3]`.
    pub positions: PathBuf,
}

/// Whether a point is in reach.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReachAnswer {
    /// Why the point is out of reach; null if it is in reach.
    pub why: Option<String>,
}
