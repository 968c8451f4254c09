//! The tests of the compiler, in one binary.

#![allow(clippy::unwrap_used)]

mod action_spaces;
mod any_text;
mod broken;
#[path = "common/chance.rs"]
mod chance;
mod common;
mod explained;
mod faults;
mod fixes;
mod grids;
#[path = "common/growth.rs"]
mod growth;
mod import_circles;
#[path = "common/inputs.rs"]
mod inputs;
mod language;
mod messages;
mod mutations;
mod pointing;
mod programs;
#[path = "common/promises.rs"]
mod promises;
mod reference;
mod rendering;
mod schema;
#[path = "common/spaces.rs"]
mod spaces;
mod verdicts;
mod wasm;
