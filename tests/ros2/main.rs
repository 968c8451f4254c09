//! The connection to ROS 2, tested with a node over a DDS by others, Eclipse Cyclone DDS. `make test-all` runs it.

#![allow(clippy::unwrap_used)]

mod nodes;

mod arm;
mod rollouts;

#[path = "../../runtime/arm/src/tests/fault.rs"]
mod fault;
// The same laboratory and the same folds as over ROS 1.
#[allow(dead_code)]
#[path = "../ros/lab.rs"]
mod lab;
#[path = "../ros/touching.rs"]
mod touching;
#[path = "../ros/whole.rs"]
mod whole;
