//! `fabc robot`: checks, recovers and enables an arm, and asks the person beside it.
//!
//! In: an arm's settings, a run folder, typed lines and keys. Out: what is usable, how a run left the arm, confirmation to
//! move. Nothing here moves an arm; the watchdog stops one, and `enable` enables it again.

pub mod check;
pub mod connect;
mod enable;
mod hold_key;
pub mod preflight;
mod recover;
pub mod terminal;
pub mod watchdog;

use crate::exit::{Exit, Failure};
use crate::io::Io;

const BY_HAND: &str = "\
This command does not move the arm. Bring the arm to rest by hand or with the vendor's tools, take the cloth out of \
its fingers, then state what you did, with --how or when asked. Caution: `home` in the vendor's driver opens the \
hand and drops what it holds.

Exit codes: 0 the arm is clear, 2 no recovery was stated, and nothing was changed.";

const LET_GO: &str = "\
A stopped arm stays stopped until this command enables it; no other command does. The arm does not move: to verify \
that it accepts motion, fabc re-sends its current pose. Whatever the gripper holds, and the state that a run left, \
are unchanged: see `fabc robot recover`. A simulated arm ends with its program, and is never left stopped.

Exit codes: 0 enabled, 2 no reason was given or enabling could not be verified, 64 wrong usage.";

crate::verbs::verbs! {
    /// What to do.
    RobotVerb:
    /// Checks an arm's settings and calibration, and says which part of the workspace it reaches.
    Check(check::RobotCheckArguments),
    /// Says in what state a run left the arm, and records what a person did about it.
    #[command(after_help = BY_HAND)]
    Recover(recover::RecoverArguments),
    /// Lets a stopped arm move again, after a person has said why.
    #[command(after_help = LET_GO)]
    Enable(enable::EnableArguments),
    /// Stops the arm when no more lines arrive on stdin; started by the command that moves the arm.
    #[command(hide = true)]
    Watchdog(watchdog::WatchdogArguments),
}

pub fn run(verb: &RobotVerb, io: &Io) -> Result<Exit, Failure> {
    verb.run(io)
}
