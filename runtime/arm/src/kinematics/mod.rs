//! Where an arm's joints bring its tool, which joints bring it to a pose, and what it reaches.
//!
//! In: a model's name; angles, poses and points in the base frame, metres and radians. Out: frames, angles, straight
//! ways, and the range that a hand pointing down reaches. Whether the arm hits itself, the table or anything else on
//! its way is not looked at here.

pub mod chain;
pub mod inverse;
pub mod models;
pub mod reach;
mod starts;
pub mod straight;
pub mod tool_down;

#[cfg(test)]
mod tests;
