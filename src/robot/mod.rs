//! `fabc robot`: looks after an arm, and stands between it and the person beside it.
//!
//! In: an arm's settings, a run folder, lines and keys. Out: what can be used, what was left, leave to move. Nothing here
//! moves an arm; the watchdog stops one, and `enable` lets it go again.

mod check;
pub mod connect;
mod enable;
mod held;
mod recover;
pub mod standing;
pub mod terminal;
pub mod watchdog;

use crate::cli::robot::{RobotArguments, RobotVerb};
use crate::exit::{Exit, Failure};

pub use held::restore as restore_terminal;

/// Does what is asked.
pub fn run(arguments: &RobotArguments) -> Result<Exit, Failure> {
    match &arguments.verb {
        RobotVerb::Check(arguments) => check::run(arguments),
        RobotVerb::Recover(arguments) => recover::run(arguments),
        RobotVerb::Enable(arguments) => enable::run(arguments),
        RobotVerb::Watchdog(arguments) => watchdog::run(arguments),
    }
}
