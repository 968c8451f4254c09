//! Arguments of `review`.

use clap::Args;
use std::path::PathBuf;

const KEYS: &str = "\
Without --json, --accept, --reject and --accept-all it asks on the terminal; `?` lists the keys.
An ID is a group's (8 letters of its hash), a snapshot's (its file name without `.snap`), or the
path of a snapshot, pending or accepted.";

/// Arguments of `review`.
#[derive(Args)]
#[command(after_help = KEYS)]
pub struct ReviewArguments {
    /// Folders in and below which snapshots are looked for, or files whose snapshots are meant; default: the current folder.
    #[arg(value_name = "FOLDER|FILE.fab")]
    pub places: Vec<PathBuf>,
    /// Only snapshots whose id has this in it, or fits it where it has `*` or `?`.
    #[arg(long, value_name = "PATTERN")]
    pub only: Option<String>,
    /// Accept a group or a snapshot; may be given again.
    #[arg(long, value_name = "ID")]
    pub accept: Vec<String>,
    /// Reject a group or a snapshot: what is pending goes, what was accepted stays; may be given again.
    #[arg(long, value_name = "ID")]
    pub reject: Vec<String>,
    /// Accept all that --reject does not name.
    #[arg(long, conflicts_with = "accept")]
    pub accept_all: bool,
    /// Show changes side by side at first.
    #[arg(long)]
    pub side_by_side: bool,
    /// Say what the change costs with this `PROVIDER:NAME`.
    #[cfg(feature = "runtime")]
    #[arg(long, value_name = "MODEL")]
    pub model: Option<String>,
    #[cfg(feature = "runtime")]
    #[command(flatten)]
    pub facts: super::models::FactsArguments,
    /// Write pictures before, after and their difference into this folder; default: a temporary one, when they are shown.
    #[cfg(feature = "runtime")]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}
