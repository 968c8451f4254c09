//! The parts of a [`Program`](program::Program): one file per section of the language, each plain data.
//!
//! Other modules of the crate define what the data means. Functions here compute only from a single value.

pub mod actions;
pub mod annotate;
pub mod camera;
pub mod cloth;
pub mod demos;
pub mod files;
pub mod folds;
pub mod goal;
pub mod keypoints;
pub mod manner;
pub mod material;
pub mod picker;
pub mod placeholders;
pub mod points;
pub mod program;
pub mod rehearse;
pub mod shape;
pub mod stage;
pub mod subgoals;
pub mod test;
pub mod trial;
pub mod uses;
pub mod values;
pub mod verify;
