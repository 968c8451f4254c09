//! The command line of `fabc new`.

use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

/// Arguments of `new`.
#[derive(Args)]
pub struct NewArguments {
    /// What to begin.
    #[command(subcommand)]
    pub what: NewVerb,
}

/// What to begin.
#[derive(Subcommand)]
pub enum NewVerb {
    /// Writes a folding task that runs at once, with comments that say how to change it.
    Fold(NewFoldArguments),
    /// Writes a smoothing task that runs at once, with comments that say how to change it.
    Smoothing(NewTaskArguments),
}

impl NewVerb {
    /// Returns whether stdout must be one JSON document, whatever happens.
    pub fn wants_json(&self) -> bool {
        match self {
            NewVerb::Fold(arguments) => arguments.task.json,
            NewVerb::Smoothing(arguments) => arguments.json,
        }
    }
}

/// Arguments of `new fold`.
#[derive(Args)]
pub struct NewFoldArguments {
    #[command(flatten)]
    pub task: NewTaskArguments,
    /// Pictures of your own, the flat cloth first and then one after each step: the steps are found in them.
    #[cfg(feature = "runtime")]
    #[arg(long, value_name = "PNG", num_args = 1.., value_hint = ValueHint::FilePath)]
    pub from_images: Vec<PathBuf>,
}

/// Where a new task goes.
#[derive(Args)]
pub struct NewTaskArguments {
    /// The task's name: letters, digits and `_`; the file is NAME.fab.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// The folder that gets the file; default: the current one.
    #[arg(long = "in", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub folder: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}
