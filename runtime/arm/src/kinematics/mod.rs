//! Forward and inverse kinematics of an arm, straight paths, and reach.
//!
//! In: a model's name; angles, poses and points in the base frame, metres and radians. Out: frames, angles, straight
//! paths, and the range that a hand pointing down reaches. Collisions of the arm with itself, the table or anything
//! else are not checked here.

pub mod chain;
pub mod inverse;
pub mod models;
pub mod reach;
pub mod shape;
mod starts;
pub mod straight;
pub mod tool_down;

#[cfg(test)]
mod tests;
