//! `fabc review`: shows what changed in prompts, scenes and pictures, and accepts or rejects it.
//!
//! In: snapshot folders. Out: changed folders, and the pending snapshots on a terminal or as JSON. `fabc snap` wrote
//! the pending snapshots; nothing is rendered here.

mod decide;
mod edits;
mod find;
mod groups;
mod session;
mod show;
#[cfg(test)]
mod tests;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::Args;
use decide::{Decision, Decisions, Outcome};
use find::Pending;
use groups::Group;
use serde_json::{Value, json};
use std::path::PathBuf;

const KEYS: &str = "\
Without --json, --accept, --reject and --accept-all it asks on the terminal; `?` lists the keys.
An ID is a group's (8 letters of its hash), a snapshot's (its file name without `.snap`), or the
path of a snapshot, pending or accepted.";

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
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

pub fn run(arguments: &ReviewArguments, io: &Io) -> Result<Exit, Failure> {
    let mut pending = find::find(&arguments.places, arguments.only.as_deref(), io)?;
    let is_named = !arguments.accept.is_empty() || !arguments.reject.is_empty();
    let mut outcome = None;
    if arguments.accept_all || is_named {
        outcome = Some(decide(arguments, &mut pending)?);
    }
    let groups = groups::group(&pending);
    if arguments.json {
        let shown = groups.iter().map(|group| {
            let mut shown = json!(group);
            let members = group.members.iter().map(|at| &pending[*at]);
            shown["snapshots"] = members.map(|one| json!(one)).collect();
            shown
        });
        let shown: Vec<Value> = shown.collect();
        let mut document = json!({ "groups": shown, "pending": pending.len() });
        if let Some(outcome) = outcome {
            document["accepted"] = json!(outcome.accepted);
            document["rejected"] = json!(outcome.rejected);
            document["waiting"] = json!(outcome.waiting);
        }
        io.json(&document);
    } else if let Some(outcome) = outcome {
        outcome.report(io);
    } else {
        return ask(&pending, &groups, io);
    }
    Ok(Exit::Done)
}

/// Applies the decisions of the command line, and leaves in `pending` what they do not settle.
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

fn ask(pending: &[Pending], groups: &[Group], io: &Io) -> Result<Exit, Failure> {
    if pending.is_empty() {
        io.talk("nothing is pending");
        return Ok(Exit::Done);
    }
    if !io.is_interactive() {
        let n_pending = pending.len();
        return Err(Failure::usage(format!(
            "{n_pending} snapshots are pending, and this is not a terminal; use --json, --accept, --reject or --accept-all"
        )));
    }
    session::run(Decisions::about(pending, groups), io)
}
