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

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::robot::enable::EnableArguments;
use crate::verbs::runtime::robot::recover::RecoverArguments;
use crate::verbs::runtime::robot::watchdog::WatchdogArguments;
use check::CheckArguments;
use clap::Args;
use clap::Subcommand;

/// What `recover` does not do.
const BY_HAND: &str = "\
It moves nothing itself. Bring the arm to rest by hand or by the vendor's own tools, take the cloth out of its fingers, and \
then say what was done, by --how or typed. Mind that `home` of the vendor's driver opens the hand: what it holds falls.

Exit codes: 0 clear, 2 nobody has looked after the arm, and nothing is changed.";

/// What `enable` does not do.
const LET_GO: &str = "\
An arm that was stopped, by fabc or by anybody else, stays so until this is said; no other verb lets it go. Nothing is moved: \
that the arm takes motion is found out by sending it to where it is. What its hand holds, and what a run left open, stays as \
it is: see `fabc robot recover`. A simulated arm ends with its program, and is never left stopped.

Exit codes: 0 let go, 2 nobody said why, or it cannot be verified, 64 wrong usage.";

/// Arguments of `robot`.
#[derive(Args)]
pub struct RobotArguments {
    /// What to do.
    #[command(subcommand)]
    pub verb: RobotVerb,
}

/// What to do.
#[derive(Subcommand)]
pub enum RobotVerb {
    /// Says whether an arm's settings and its calibration can be used, and what of the workspace it reaches.
    Check(CheckArguments),
    /// Says in what state a run left the arm, and notes what a person did about it.
    #[command(after_help = BY_HAND)]
    Recover(RecoverArguments),
    /// Lets a stopped arm take motion again, after a person said why.
    #[command(after_help = LET_GO)]
    Enable(EnableArguments),
    /// Stops the arm when the lines on stdin cease; started by the command that moves it.
    #[command(hide = true)]
    Watchdog(WatchdogArguments),
}

/// Runs a subcommand of `robot`.
pub fn run(arguments: &RobotArguments, io: &Io) -> Result<Exit, Failure> {
    match &arguments.verb {
        RobotVerb::Check(arguments) => check::run(arguments, io),
        RobotVerb::Recover(arguments) => recover::run(arguments, io),
        RobotVerb::Enable(arguments) => enable::run(arguments, io),
        RobotVerb::Watchdog(arguments) => watchdog::run(arguments, io),
    }
}
