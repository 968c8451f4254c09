//! The command line of `fabc bench`.

use super::model_arguments::{ModelArguments, PolicyArguments, SpendArguments};
use super::robot::ArmArguments;
use crate::setting::worlds::WorldChoice;
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// The most rollouts side by side.
const MAX_JOBS: i64 = 256;

/// Arguments of `bench`.
#[derive(Args)]
pub struct BenchArguments {
    /// A suite of tasks/suites by its name, or the path of a .toml file.
    #[arg(value_name = "SUITE")]
    pub suite: String,
    /// Who decides, where a method of the suite does not say itself.
    #[command(flatten)]
    pub policy: PolicyArguments,
    /// Who answers, where a method of the suite does not say itself.
    #[command(flatten)]
    pub model: ModelArguments,
    #[command(flatten)]
    pub spend: SpendArguments,
    /// Only this variant of the tasks.
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// Recorded starts in place of the suite's: a folder with manifest.json, or of .npy files with descriptions.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub starts: Option<PathBuf>,
    /// Rollouts per start of a model that varies; default: as the suite says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: Option<u32>,
    /// Rollouts side by side; default: one per core, 8 or more with providers. The figures do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MAX_JOBS))]
    pub jobs: Option<u16>,
    /// Only the first N starts of each task.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Where run folders and tables go; what has ended there is not run again. Default: the next free runs/bench-SUITE-NNNN.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Only part I of N of the starts, counted from 1; with one `--out`, the last call may leave it away.
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Where rollouts are carried out: `sim`, `jaco` (on an arm one at a time), or `exec:"CMD ARG..."`, a program of yours.
    #[arg(long, value_name = "WORLD", default_value = "sim")]
    pub world: WorldChoice,
    #[command(flatten)]
    pub arm: ArmArguments,
    /// Ask after each rollout whether the task was reached, and if not, why; rollouts then run one at a time. Default: with
    /// a real arm, unless `--confirm none` is said or stdin is no terminal.
    #[arg(long, conflicts_with = "jobs")]
    pub operator: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// A part of the starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which one, from 1.
    pub part: u32,
    /// Of how many.
    pub of: u32,
}

/// Reads `--shard`.
fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/');
    let parts = parts.and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
    match parts {
        Some((part, of)) if 1 <= part && part <= of => Ok(Shard { part, of }),
        _ => Err("write a part and how many there are, such as 1/3, 2/3 and 3/3".to_owned()),
    }
}
