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
    /// Offers the bundled simulator as a program that answers lines, as a world of yours does.
    Serve,
}

impl WorldVerb {
    /// Returns whether stdout must be one JSON document, whatever happens.
    pub fn wants_json(&self) -> bool {
        match self {
            WorldVerb::Check(arguments) => arguments.json,
            WorldVerb::Serve => false,
        }
    }
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
