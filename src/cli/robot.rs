//! Arguments of `robot`, and how a person watches over an arm.

use clap::{Args, Subcommand, ValueEnum, ValueHint};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

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

impl RobotVerb {
    /// Returns whether stdout must be one JSON document, whatever happens.
    pub fn wants_json(&self) -> bool {
        match self {
            RobotVerb::Check(arguments) => arguments.json,
            RobotVerb::Recover(arguments) => arguments.json,
            RobotVerb::Enable(arguments) => arguments.json,
            RobotVerb::Watchdog(_) => false,
        }
    }
}

/// The arm of `--world jaco`, and who watches it.
#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct ArmArguments {
    /// With `--world jaco`: the settings of the arm and its table.
    #[arg(long, value_name = "FILE", default_value = "robot.toml", value_hint = ValueHint::FilePath)]
    pub robot: PathBuf,
    /// What a person is asked before the arm moves; default: each pick and place of a real arm, nothing of a simulated one.
    #[arg(long, value_enum, value_name = "WHAT")]
    pub confirm: Option<Confirm>,
    /// Let the arm move only while the space bar is held.
    #[arg(long)]
    pub hold_to_run: bool,
}

impl Default for ArmArguments {
    fn default() -> Self {
        ArmArguments {
            robot: PathBuf::from("robot.toml"),
            confirm: None,
            hold_to_run: false,
        }
    }
}

/// Arguments of `robot check`.
#[derive(Args)]
pub struct CheckArguments {
    /// The arm's settings.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub robot: PathBuf,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `robot recover`.
#[derive(Args)]
pub struct RecoverArguments {
    /// The run folder.
    #[arg(value_name = "RUN", value_hint = ValueHint::DirPath, required_unless_present = "robot")]
    pub run: Option<PathBuf>,
    /// In place of the run folder: the settings of the arm, whose last run is meant, also where its folder is gone.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "run")]
    pub robot: Option<PathBuf>,
    /// What was done, in words; default: it is asked for.
    #[arg(long, value_name = "WORDS")]
    pub how: Option<String>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `robot enable`.
#[derive(Args)]
pub struct EnableArguments {
    /// The arm's settings.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub robot: PathBuf,
    /// Why it was stopped and may go, in words; default: it is asked for.
    #[arg(long, value_name = "WORDS")]
    pub how: Option<String>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `robot watchdog`.
#[derive(Args)]
pub struct WatchdogArguments {
    /// The arm's settings.
    #[arg(long, value_name = "FILE")]
    pub robot: PathBuf,
    /// The longest without a sign of life, seconds.
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub timeout: f64,
}

/// What a person is asked before an arm moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Confirm {
    /// Once before each pick and place.
    Each,
    /// Before each part of it.
    Segment,
    /// Nothing.
    None,
}

fn seconds(text: &str) -> Result<f64, String> {
    let read = text.parse().ok().filter(|it| (0.05..=60.0).contains(it));
    read.ok_or_else(|| "write seconds, 0.05 to 60".to_owned())
}
