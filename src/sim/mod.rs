//! `fabc sim`: the simulator on its own, one file per verb.
//!
//! Here is nothing of tasks, prompts or models. Every verb's JSON names the hash of the simulator's
//! parameters as `params`.

mod crumple;
mod export;
mod render;
mod replay;
mod time;

mod demonstrations;
mod files;
mod parallel;

use crate::cli::sim::{SimArguments, SimVerb};
use crate::exit::{Exit, Failure};

/// Distance between neighbours in a flat cloth where nothing says otherwise, metres (protocol, section 1).
const SPACING_M: f64 = 0.00625;

/// Runs one of the verbs.
pub fn run(arguments: &SimArguments) -> Result<Exit, Failure> {
    match &arguments.verb {
        SimVerb::Replay(arguments) => replay::run(arguments),
        SimVerb::Time(arguments) => time::run(arguments),
        SimVerb::Crumple(arguments) => crumple::run(arguments),
        SimVerb::Render(arguments) => render::run(arguments),
        SimVerb::Export(arguments) => export::run(arguments),
    }
}
