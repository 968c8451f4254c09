//! `fabc review`: shows what changed in prompts, scenes and pictures, and accepts or rejects it.
//!
//! In: snapshot folders. Out: changed folders, and the pending snapshots on a terminal or as JSON. `fabc snap` wrote
//! the pending snapshots; nothing is rendered here.

mod decide;
mod edits;
mod find;
mod groups;
mod pictures;
mod session;
mod show;
#[cfg(test)]
mod tests;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::Args;
use decide::{Decision, Decisions, Outcome};
use find::{Pending, ReviewItems};
use groups::{Group, Kind};
use pictures::Comparison;
use serde::Serialize;
use session::Session;
use std::path::{Path, PathBuf};

const KEYS: &str = "\
Without --json, --accept, --reject and --accept-all it asks on the terminal; `?` lists the keys.
An ID is a group's (8 letters of its hash), a snapshot's (its file name without `.snap`), or the
path of a snapshot, pending or accepted.";

/// Arguments of `review`.
#[derive(Args)]
#[command(after_help = KEYS)]
pub struct ReviewArguments {
    /// Folders to search for snapshots, with their subfolders, or task files; default: the current folder.
    #[arg(value_name = "FOLDER|FILE.fab")]
    pub places: Vec<PathBuf>,
    /// Only snapshots whose id contains this.
    #[arg(long, value_name = "PART")]
    pub only: Option<String>,
    /// Accept a group or a snapshot; may be given again.
    #[arg(long, value_name = "ID")]
    pub accept: Vec<String>,
    /// Reject a group or a snapshot: delete the pending version, keep the accepted one; repeatable.
    #[arg(long, value_name = "ID")]
    pub reject: Vec<String>,
    /// Accept all that --reject does not name.
    #[arg(long, conflicts_with = "accept")]
    pub accept_all: bool,
    /// Write the pictures before and after, and their difference, into this folder; default: a temporary one, when they are shown.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// The JSON of a review: what is pending, and what was decided.
#[derive(Serialize)]
struct Review<'r> {
    groups: Vec<ShownGroup<'r>>,
    pending: usize,
    /// Pending snapshots that other programs wrote.
    foreign: usize,
    #[serde(flatten)]
    outcome: Option<&'r Outcome>,
}

/// A group with its snapshots.
#[derive(Serialize)]
struct ShownGroup<'r> {
    #[serde(flatten)]
    group: &'r Group,
    picture: Option<Comparison>,
    snapshots: Vec<&'r Pending>,
}

/// Reviews the pending snapshots.
pub fn run(arguments: &ReviewArguments, io: &Io) -> Result<Exit, Failure> {
    let ReviewItems {
        mut pending,
        n_foreign,
    } = find::find(&arguments.places, arguments.only.as_deref(), io)?;
    let decides =
        arguments.accept_all || !arguments.accept.is_empty() || !arguments.reject.is_empty();
    let outcome = if decides {
        Some(decide(arguments, &mut pending)?)
    } else {
        None
    };
    let groups = groups::group(&pending);
    if arguments.json {
        let review = Review {
            groups: shown(&groups, &pending, arguments.out.as_deref())?,
            pending: pending.len(),
            foreign: n_foreign,
            outcome: outcome.as_ref(),
        };
        io.json(&review);
    } else if let Some(outcome) = outcome {
        outcome.report(io);
    } else {
        return ask(arguments, &pending, n_foreign, &groups, io);
    }
    Ok(Exit::Done)
}

/// Applies the decisions of the command line, and leaves in `pending` what they do not settle; an unknown id ends it
/// before anything is changed.
fn decide(arguments: &ReviewArguments, pending: &mut Vec<Pending>) -> Result<Outcome, Failure> {
    let groups = groups::group(pending);
    let mut decisions = Decisions::about(pending, &groups);
    decisions.decide_named(&arguments.accept, Decision::Accept)?;
    decisions.decide_named(&arguments.reject, Decision::Reject)?;
    if arguments.accept_all {
        decisions.accept_others();
    }
    decisions.apply()?;
    let outcome = decisions.outcome();
    let settled = (0..pending.len()).map(|at| decisions.is_settled(at));
    let mut settled = settled.collect::<Vec<bool>>().into_iter();
    pending.retain(|_| settled.next() == Some(false));
    Ok(outcome)
}

/// Asks about each group on the terminal.
fn ask(
    arguments: &ReviewArguments,
    pending: &[Pending],
    n_foreign: usize,
    groups: &[Group],
    io: &Io,
) -> Result<Exit, Failure> {
    if n_foreign > 0 {
        io.talk(&format!(
            "ignored: {n_foreign} pending snapshots that fabc did not write"
        ));
    }
    if pending.is_empty() {
        io.talk("nothing is pending");
        return Ok(Exit::Done);
    }
    if !io.is_interactive() {
        return Err(Failure::usage(format!(
            "{} snapshots are pending, and this is not a terminal; use --json, --accept, --reject or --accept-all",
            pending.len()
        )));
    }
    let temporary = || std::env::temp_dir().join(format!("fabc-review-{}", std::process::id()));
    let session = Session {
        decisions: Decisions::about(pending, groups),
        sheets: &arguments.out.clone().unwrap_or_else(temporary),
    };
    session.run(io)
}

/// Returns the groups with their snapshots, and with comparisons of pictures if a folder for them is named.
fn shown<'r>(
    groups: &'r [Group],
    pending: &'r [Pending],
    sheets: Option<&Path>,
) -> Result<Vec<ShownGroup<'r>>, Failure> {
    let shown = groups.iter().map(|group| {
        let snapshots: Vec<&Pending> = group.members.iter().map(|at| &pending[*at]).collect();
        let picture = match sheets {
            Some(folder) if group.kind == Kind::Picture => {
                Some(pictures::compare(snapshots[0], &group.id, folder)?)
            }
            _ => None,
        };
        Ok(ShownGroup {
            group,
            picture,
            snapshots,
        })
    });
    shown.collect()
}
