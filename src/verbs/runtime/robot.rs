//! `fabc robot`: checks and recovers an arm, and asks the person beside it.
//!
//! In: an arm's settings, typed lines and keys. Out: what is usable, how the last run left the arm, confirmation to move.
//! Nothing here moves an arm; the watchdog stops one, and `recover` lets it move again.

pub mod check;
pub mod connect;
pub mod hold_key;
pub mod preflight;
mod recover;
pub mod terminal;
pub mod watchdog;

use crate::exit::{Exit, Failure};
use crate::io::Io;

const BY_HAND: &str = "\
fabc moves nothing: it lets the arm move again, and verifies that. A stopped arm stays stopped until then. A simulated arm ends \
with its program, and needs nothing.

Exit codes: 0 the arm is clear and accepts motion, 2 nothing was stated, or that could not be verified.";

crate::verbs::verbs! {
    /// What to do.
    RobotVerb:
    /// Checks an arm's settings and calibration, and says which part of the workspace it reaches.
    Check(check::RobotCheckArguments),
    /// Says how the last run left an arm, records what a person did about it, and lets the arm move again.
    #[command(after_help = BY_HAND)]
    Recover(recover::RecoverArguments),
    /// Stops the arm when no more lines arrive on stdin; started by the command that moves the arm.
    #[command(hide = true)]
    Watchdog(watchdog::WatchdogArguments),
}

pub fn run(verb: &RobotVerb, io: &Io) -> Result<Exit, Failure> {
    verb.run(io)
}
