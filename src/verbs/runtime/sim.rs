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

use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::Args;
use fab_base::parallel::in_parallel;
use fab_sim::Grid;
use std::num::NonZero;
use std::thread;

/// The most threads that a verb starts.
const MAX_THREADS: i64 = 256;

crate::verbs::verbs! {
    /// What to do with the simulator.
    SimVerb:
    /// Replays recorded demonstrations and compares the final cloths, particle by particle.
    Replay(replay::ReplayArguments),
    /// Times one fold along the diagonal, every step computed.
    Time(time::TimeArguments),
    /// Crumples cloths by their seeds and says how much of the table each covers.
    Crumple(crumple::CrumpleArguments),
    /// Measures a material on simulated specimens, as a textile laboratory measures cloth.
    Measure(measure::MeasureArguments),
    /// Draws particle positions as the camera over the table sees them.
    Render(render::DrawArguments),
    /// Films picks and places, given or recorded, as an animated GIF.
    Record(record::RecordArguments),
    /// Writes particle positions in the world frame, or the cloth as a mesh.
    Export(export::ExportArguments),
}

/// Distance between neighbours in a flat cloth unless stated otherwise, metres (protocol, section 1).
const SPACING_M: f64 = 0.00625;

pub fn run(verb: &SimVerb, io: &Io) -> Result<Exit, Failure> {
    verb.run(io)
}

/// Returns the grid of a square cloth, as `--size` states it.
fn square(size: u32) -> Result<Grid, Failure> {
    grid([size; 2], &format!("--size {size}"))
}

/// Returns a grid of the usual spacing; `stated` is the option that states it, for the message.
fn grid([dimx, dimy]: [u32; 2], stated: &str) -> Result<Grid, Failure> {
    Grid::new(dimx as usize, dimy as usize, SPACING_M as f32)
        .map_err(|error| Failure::usage(format!("`{stated}`: {error}")))
}

/// How many cloths are simulated side by side.
#[derive(Args)]
pub struct ThreadArguments {
    /// Cloths simulated side by side; default: one per core.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MAX_THREADS))]
    pub threads: Option<u16>,
}

/// Returns the number of threads asked for, or one per core.
pub fn threads(arguments: &ThreadArguments) -> usize {
    arguments.threads.map_or_else(
        || thread::available_parallelism().map_or(1, NonZero::get),
        usize::from,
    )
}

/// Simulates `count` cloths, with a line of progress; the first failure or an interrupt ends all.
pub fn each<T: Send>(
    count: usize,
    arguments: &ThreadArguments,
    what: &str,
    io: &Io,
    simulate: impl Fn(usize) -> Result<T, Failure> + Sync,
) -> Result<Vec<T>, Failure> {
    let show = |done: usize| io.progress(&format!("{done} of {count} {what}"));
    show(0);
    let simulate = |index| simulate(index).map(Some);
    let results = in_parallel(count, threads(arguments), simulate, show);
    io.progress("");
    Ok(results?.into_iter().flatten().collect())
}
