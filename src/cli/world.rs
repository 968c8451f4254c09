//! The command line of `fabc world`.

use crate::setting::worlds::WorldChoice;
use clap::{Args, Subcommand};

/// Arguments of `world`.
#[derive(Args)]
pub struct WorldArguments {
    /// What to do.
    #[command(subcommand)]
    pub verb: WorldVerb,
}

/// What to do with a world.
#[derive(Subcommand)]
pub enum WorldVerb {
    /// Says which promises of every world one of yours keeps.
    Check(CheckArguments),
}

/// Arguments of `world check`.
#[derive(Args)]
pub struct CheckArguments {
    /// The world: `exec:"CMD ARG..."`, or `sim` to see what is promised.
    #[arg(value_name = "WORLD")]
    pub world: WorldChoice,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}
