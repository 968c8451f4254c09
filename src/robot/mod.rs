//! `fabc robot`: checks, recovers and enables an arm, and asks the person beside it.
//!
//! In: an arm's settings, a run folder, typed lines and keys. Out: what is usable, how a run left the arm, confirmation to
//! move. Nothing here moves an arm; the watchdog stops one, and `enable` enables it again.

mod check;
pub mod connect;
mod enable;
mod hold_key;
pub mod preflight;
mod recover;
pub mod terminal;
pub mod watchdog;

use crate::cli::robot::{RobotArguments, RobotVerb};
use crate::exit::{Exit, Failure};

pub use hold_key::restore as restore_terminal;

/// Runs a subcommand of `robot`.
pub fn run(arguments: &RobotArguments) -> Result<Exit, Failure> {
    match &arguments.verb {
        RobotVerb::Check(arguments) => check::run(arguments),
        RobotVerb::Recover(arguments) => recover::run(arguments),
        RobotVerb::Enable(arguments) => enable::run(arguments),
        RobotVerb::Watchdog(arguments) => watchdog::run(arguments),
    }
}
