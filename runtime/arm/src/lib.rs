//! The arm: where it can reach, where a camera's pixels lie for it, how it moves, and who drives it.
//!
//! ```text
//! Motion → route → Limited → Arm (a driver) → Port (messages) → an arm, or the simulated one
//! ```
//!
//! Lengths are metres and angles radians. The base frame is the arm's own (`link_base`): z up along the axis of the
//! first joint. A tool pose is `base_from_tool`; its z axis points out of the hand, so that a hand that points down has
//! it along minus z of the base. Nothing here knows of tasks, prompts or models.

pub mod calibration;
pub mod directory;
pub mod driver;
pub mod execute;
pub mod kinematics;
pub mod last;
pub mod limits;
pub mod log;
pub mod plan;
pub mod port;
pub mod rgbd;
pub mod route;
pub mod settings;
pub mod sight;
pub mod simulated;
pub mod supervisor;
pub mod table;
pub mod world;

#[cfg(test)]
mod tests;
