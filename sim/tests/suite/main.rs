//! The tests of the simulator, in one binary.

#![allow(clippy::unwrap_used)]

mod camera;
mod camera_recorded;
mod crumple;
mod crumple_recorded;
mod dropping;
mod laws;
mod manners;
mod mask;
mod mesh;
mod recorded;
mod replay;
#[path = "../../benches/cloths/shipped.rs"]
mod shipped;
mod simulator;
mod square;
mod textile;
