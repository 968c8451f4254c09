//! The tests of the agent, in one binary.

#![allow(clippy::unwrap_used)]

mod geometric_recorded;
mod moved_camera;
mod records;
