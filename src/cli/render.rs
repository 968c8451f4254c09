//! Arguments of `render`.

#[cfg(feature = "runtime")]
use super::StartArguments;
use super::TaskArguments;
#[cfg(feature = "runtime")]
use super::models::FactsArguments;
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// Arguments of `render`.
#[derive(Args)]
pub struct RenderArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    /// Only this stage.
    #[arg(long, value_name = "NAME")]
    pub stage: Option<String>,
    /// The step whose prompts are shown; earlier steps are done as demonstrated, or as the stand-in decides.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub step: u32,
    /// Points by keypoint name, as JSON: `{"corners": [[u, v], …], "center": [[u, v]]}`, instead of a camera's.
    #[arg(long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub scene: Option<PathBuf>,
    #[cfg(feature = "runtime")]
    #[command(flatten)]
    pub start: StartArguments,
    #[cfg(feature = "runtime")]
    #[command(flatten)]
    pub shown: ShownArguments,
    /// What a model answered, in the order of the questions; shows what follows, such as the message of a refusal.
    #[cfg(feature = "runtime")]
    #[arg(long = "reply", value_name = "TEXT", conflicts_with = "scene")]
    pub replies: Vec<String>,
    /// Show which component, file and line each line comes from, and what each component weighs in tokens.
    #[arg(long)]
    pub why: bool,
    /// Write the messages and the pictures into this folder.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Do it again whenever a file that it used changes, until Ctrl-C.
    #[arg(long, conflicts_with = "json")]
    pub watch: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// To which model messages are shown as it would be sent them.
#[cfg(feature = "runtime")]
#[derive(Args)]
pub struct ShownArguments {
    /// Show what this `PROVIDER:NAME` would be sent, with points as it writes them; default: in the task's pixels.
    #[arg(long, value_name = "MODEL")]
    pub model: Option<String>,
    /// Show what a model would be sent that chooses numbered points.
    #[arg(long)]
    pub marks: bool,
    #[command(flatten)]
    pub facts: FactsArguments,
}
