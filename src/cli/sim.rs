//! The command line of `fabc sim`.

use super::FrameArguments;
use clap::{Args, Subcommand, ValueEnum, ValueHint};
use std::path::PathBuf;

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
    /// Replays recorded demonstrations and compares the ends, particle by particle.
    Replay(ReplayArguments),
    /// Times one fold along the diagonal, every step computed.
    Time(TimeArguments),
    /// Crumples cloths by their seeds and says how much of the table each covers.
    Crumple(CrumpleArguments),
    /// Draws particle positions as the camera over the table sees them.
    Render(DrawArguments),
    /// Writes particle positions in the world frame, or the cloth as a mesh.
    Export(ExportArguments),
}

impl SimVerb {
    /// Returns whether stdout must be one JSON document, whatever happens.
    pub fn wants_json(&self) -> bool {
        match self {
            SimVerb::Replay(arguments) => arguments.json,
            SimVerb::Time(arguments) => arguments.json,
            SimVerb::Crumple(arguments) => arguments.json,
            SimVerb::Render(arguments) => arguments.json,
            SimVerb::Export(arguments) => arguments.json,
        }
    }
}

/// How many cloths are simulated side by side.
#[derive(Args)]
pub struct ThreadArguments {
    /// Cloths simulated side by side; default: one per core.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MAX_THREADS))]
    pub threads: Option<u16>,
}

/// Arguments of `sim replay`.
#[derive(Args)]
pub struct ReplayArguments {
    /// The folder with manifest.json; the manifest's paths begin at the folder above it.
    #[arg(value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub folder: PathBuf,
    /// Only demonstrations with these ids.
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    pub ids: Option<Vec<u64>>,
    /// Only demonstrations of this task, by the recorded data's own name.
    #[arg(long, value_name = "NAME")]
    pub task: Option<String>,
    /// Replace a parameter of the simulator, such as `substeps=8`.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub changes: Vec<String>,
    #[command(flatten)]
    pub threads: ThreadArguments,
    /// List each demonstration, not only each task.
    #[arg(long)]
    pub each: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `sim time`.
#[derive(Args)]
pub struct TimeArguments {
    /// Particles along each side of the cloth.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(25..=200))]
    pub size: u32,
    /// Cloths folded side by side.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=MAX_THREADS))]
    pub threads: u16,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `sim crumple`.
#[derive(Args)]
pub struct CrumpleArguments {
    /// Particles along each side of a square cloth, 6.25 mm apart; default: 40.
    #[arg(long, value_name = "N", conflicts_with = "dims")]
    pub size: Option<u32>,
    /// Particles along the two sides of a cloth that is not square.
    #[arg(long, value_name = "44x40")]
    pub dims: Option<String>,
    /// Which particles of the grid there are: rows of `#` and `.`, seen from above; its size is the cloth's.
    #[arg(long, value_name = "FILE.txt", value_hint = ValueHint::FilePath)]
    pub outline: Option<PathBuf>,
    /// The first cloth's seed; the others have the numbers after it.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    pub seed: u64,
    /// How many cloths are crumpled.
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub count: u32,
    /// The folder that gets positions (.npy) and what describes them (.json beside it).
    #[arg(short = 'o', long = "out", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub threads: ThreadArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Which particles lie where.
#[derive(Args)]
pub struct StateArguments {
    /// Particle positions.
    #[arg(value_name = "STATE.npy", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    #[command(flatten)]
    pub frame: FrameArguments,
    /// Which particles of the grid there are: rows of `#` and `.`, seen from above; default: as described, else all.
    #[arg(long, value_name = "FILE.txt", value_hint = ValueHint::FilePath)]
    pub outline: Option<PathBuf>,
}

/// Arguments of `sim render`.
#[derive(Args)]
pub struct DrawArguments {
    #[command(flatten)]
    pub state: StateArguments,
    /// The picture; default: STATE.png in the working folder.
    #[arg(short = 'o', long = "out", value_name = "FILE.png", value_hint = ValueHint::FilePath)]
    pub out: Option<PathBuf>,
    /// Whose camera looks.
    #[arg(long, value_enum, default_value = "folding")]
    pub camera: CameraArgument,
    /// The picture's side, pixels; default: the camera's own.
    #[arg(long, value_name = "PX")]
    pub size: Option<u32>,
    /// Draw the distance from the camera instead of colour: grey is the whole part of 255 per metre.
    #[arg(long)]
    pub depth: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// The paper's cameras; both look straight down with a field of view of 45 degrees.
#[derive(Clone, Copy, ValueEnum)]
pub enum CameraArgument {
    /// 0.65 m above the table, 224 pixels, +Y of the table is up.
    Folding,
    /// 1 m above the table, 720 pixels, +X of the table is up.
    Smoothing,
}

/// Arguments of `sim export`.
#[derive(Args)]
pub struct ExportArguments {
    #[command(flatten)]
    pub state: StateArguments,
    /// Positions with a description beside them (.npy), or a mesh (.obj).
    #[arg(short = 'o', long = "out", value_name = "FILE.npy|FILE.obj", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}
