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
use decide::{Decision, Decisions};
use find::Pending;
use groups::Group;
use serde_json::{Value, json};
use std::path::PathBuf;

const KEYS: &str = "\
Without --json, --accept, --reject and --accept-all it asks on the terminal; `?` lists the keys.
An ID is a group's, 8 letters of its hash; with --only, a group is what is left of it.";

#[derive(Args)]
#[command(after_help = KEYS)]
pub struct ReviewArguments {
    /// Folders to search for snapshots, with their subfolders, or task files; default: the current folder.
    #[arg(value_name = "FOLDER|FILE.fab")]
    pub places: Vec<PathBuf>,
    /// Only snapshots whose id contains this.
    #[arg(long, value_name = "PART")]
    pub only: Option<String>,
    /// Accept a group; may be given again.
    #[arg(long, value_name = "ID")]
    pub accept: Vec<String>,
    /// Reject a group: delete the pending versions, keep the accepted ones; may be given again.
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
    let mut groups = groups::group(&pending);
    let is_named = !arguments.accept.is_empty() || !arguments.reject.is_empty();
    let mut outcome = None;
    if arguments.accept_all || is_named {
        let mut decisions = Decisions::about(&pending, &groups);
        decisions.decide_named(&arguments.accept, Decision::Accept)?;
        decisions.decide_named(&arguments.reject, Decision::Reject)?;
        if arguments.accept_all {
            decisions.accept_others();
        }
        decisions.apply()?;
        outcome = Some(decisions.outcome());
        pending.retain(|one| one.path.exists());
        groups = groups::group(&pending);
    }
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
