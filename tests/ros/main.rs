//! The connection to ROS 1, tested with ROS itself: its master, its Python nodes, actionlib's servers. `make test-all`
//! runs it.

#![allow(clippy::unwrap_used)]

mod arm;
mod camera;
mod definitions;
#[path = "../../runtime/arm/src/tests/fault.rs"]
mod fault;
mod faults;
mod folds;
mod key;
mod lab;
mod nodes;
mod person;
mod rollouts;
mod stopping;
mod touching;
mod whole;
