//! Executes a compiled [`Program`](fab_program::Program).
//!
//! ```text
//! World.observe → Observation → Scene → Request → Reply → Proposal → Verdict     per attempt
//!                                          ▲                           │ reject: say why, ask again
//!                                          └───────────────────────────┘
//! accept → Action → World.act → Executed → step line → Report
//! ```
//!
//! [`rollout::run`] is that pipeline. Two traits open it: [`world::World`] and [`model::Model`].
//! Nothing here reads the environment, prints, or knows the command line.

pub mod rollout;

pub mod bench;

pub mod action;
pub mod agent;
pub mod calls;
pub mod scene;

pub mod arm;
pub mod model;
pub mod vision;
pub mod world;

pub mod camera;
pub mod chance;
pub mod crumple;
pub mod demos;
pub mod draft;
pub mod examples;
pub mod expert;
pub mod files;
pub mod interrupt;
pub mod metrics;
pub mod observation;
pub mod operator;
pub mod outcome;
pub mod parallel;
pub mod picture;
pub mod pictures;
pub mod result;
pub mod see;
pub mod serve;
pub mod start;
pub mod subgoals;

pub mod cache;
pub mod journal;
pub mod npy;
pub mod sheet;
pub mod store;

mod bounded;
mod digest;
#[cfg(test)]
#[path = "../../tests/recorded_data.rs"]
mod recorded;
mod regions;
