//! An arm over a table as a world: settings and descriptions, kinematics, calibration, plans, the guard of motions, drivers,
//! cameras, and the same arm simulated.
//!
//! ```text
//! Motion → plan → Guard → Checked motions → Limited → Guard → Arm (a driver) → Port (messages) → an arm
//! ```
//!
//! Lengths are metres and angles radians. The base frame is the arm's own (`link_base`): z points up along the axis of
//! the first joint. A tool pose is `base_from_tool`; its z axis points out of the hand, so it is minus z of the base
//! when the hand points down. Nothing here knows about tasks, prompts or language models.

pub mod calibration;
pub mod description;
pub mod directory;
pub mod driver;
pub mod execute;
pub mod guard;
pub mod journal;
pub mod kinematics;
pub mod limits;
pub mod phase;
pub mod plan;
pub mod port;
pub mod rgbd;
pub mod route;
pub mod settings;
pub mod sight;
pub mod simulated;
pub mod supervisor;
pub mod table;
pub mod timing;
pub mod world;

#[cfg(test)]
mod tests;
