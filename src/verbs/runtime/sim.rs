//! `fabc sim`: the simulator on its own, one file per verb.
//!
//! Nothing here knows tasks, prompts or models. Every verb's JSON gives the hash of the simulator's parameters as
//! `params`.

mod crumple;
mod export;
mod measure;
mod record;
mod render;
mod replay;
mod time;

mod demonstrations;
mod files;
pub mod parallel;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::sim::crumple::CrumpleArguments;
use crate::verbs::runtime::sim::export::ExportArguments;
use crate::verbs::runtime::sim::measure::MeasureArguments;
use crate::verbs::runtime::sim::record::RecordArguments;
use crate::verbs::runtime::sim::render::DrawArguments;
use crate::verbs::runtime::sim::replay::ReplayArguments;
use crate::verbs::runtime::sim::time::TimeArguments;
use clap::Args;
use clap::Subcommand;

/// The most threads that a verb starts.
const MAX_THREADS: i64 = 256;

/// Arguments of `sim`.
#[derive(Args)]
pub struct SimArguments {
    /// What to do.
    #[command(subcommand)]
    pub verb: SimVerb,
}

/// What to do with the simulator.
#[derive(Subcommand)]
pub enum SimVerb {
    /// Replays recorded demonstrations and compares the final cloths, particle by particle.
    Replay(ReplayArguments),
    /// Times one fold along the diagonal, every step computed.
    Time(TimeArguments),
    /// Crumples cloths by their seeds and says how much of the table each covers.
    Crumple(CrumpleArguments),
    /// Measures a material on simulated specimens, as a textile laboratory measures cloth.
    Measure(MeasureArguments),
    /// Draws particle positions as the camera over the table sees them.
    Render(DrawArguments),
    /// Films picks and places, given or recorded, as an animated GIF.
    Record(RecordArguments),
    /// Writes particle positions in the world frame, or the cloth as a mesh.
    Export(ExportArguments),
}

/// Distance between neighbours in a flat cloth unless stated otherwise, metres (protocol, section 1).
const SPACING_M: f64 = 0.00625;

/// Runs one of the subcommands.
pub fn run(arguments: &SimArguments, io: &Io) -> Result<Exit, Failure> {
    match &arguments.verb {
        SimVerb::Replay(arguments) => replay::run(arguments, io),
        SimVerb::Time(arguments) => time::run(arguments, io),
        SimVerb::Crumple(arguments) => crumple::run(arguments, io),
        SimVerb::Measure(arguments) => measure::run(arguments, io),
        SimVerb::Render(arguments) => render::run(arguments, io),
        SimVerb::Record(arguments) => record::run(arguments, io),
        SimVerb::Export(arguments) => export::run(arguments, io),
    }
}
