//! `fabc review`: shows what changed in prompts, scenes and pictures, and accepts or rejects it.
//!
//! In: snapshot folders. Out: changed folders, and the pending snapshots on a terminal or as JSON. `fabc snap` wrote
//! the pending snapshots; nothing is rendered here.

mod cost;
mod decide;
mod difference;
mod edits;
mod find;
mod groups;
#[cfg_attr(feature = "runtime", path = "review/with_models.rs")]
#[cfg_attr(not(feature = "runtime"), path = "review/without_models.rs")]
mod models;
mod session;
mod sheets;
mod show;
mod styled;
#[cfg(test)]
mod tests;
mod words;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::snapshots::Name;
use clap::Args;
use cost::Pricing;
use decide::{Decision, OpenDecisions, Selection};
use find::{Pending, ReviewItems};
use groups::{Group, Kind};
use serde_json::{Value, json};
use sheets::Sheets;
use show::Layout;
use std::collections::BTreeSet;
use std::path::PathBuf;

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
    /// Only snapshots whose id contains this, or matches it as a pattern with `*` and `?`.
    #[arg(long, value_name = "PATTERN")]
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
    /// Show changes side by side at first.
    #[arg(long)]
    pub side_by_side: bool,
    #[command(flatten)]
    pub shown: models::ReviewShownArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Reviews the pending snapshots.
pub fn run(arguments: &ReviewArguments, io: &Io) -> Result<Exit, Failure> {
    let mut found = find::find(&arguments.places)?;
    if let Some(pattern) = &arguments.only {
        found
            .pending
            .retain(|one| decide::fits(pattern, one.name.as_str()));
    }
    for why in found
        .pending
        .iter()
        .filter_map(|one| one.unreadable.as_ref())
    {
        io.talk(&format!("counted as new: {why}"));
    }
    let groups = groups::group(&found.pending);
    let pricing = models::pricing(&arguments.shown, io)?;
    let mut sheets = Sheets::new(arguments.shown.folder());
    let decides =
        arguments.accept_all || !arguments.accept.is_empty() || !arguments.reject.is_empty();
    if decides {
        return by_id(
            arguments,
            &mut found,
            &groups,
            pricing.as_ref(),
            &mut sheets,
            io,
        );
    }
    if arguments.json {
        let value = as_json(&found, &groups, pricing.as_ref(), &mut sheets)?;
        io.json(&value);
        return Ok(Exit::Done);
    }
    if found.n_foreign > 0 {
        io.talk(&format!(
            "ignored: {} pending snapshots that fabc did not write",
            found.n_foreign
        ));
    }
    if found.pending.is_empty() {
        io.talk("nothing is pending");
        return Ok(Exit::Done);
    }
    if !io.is_interactive() {
        return Err(Failure::usage(format!(
            "{} snapshots are pending, and this is not a terminal; use --json, --accept, --reject or --accept-all",
            found.pending.len()
        )));
    }
    let layout = match arguments.side_by_side {
        true => Layout::SideBySide,
        false => Layout::Unified,
    };
    session::run(
        &mut found,
        &groups,
        pricing.as_ref(),
        &mut sheets,
        layout,
        io,
    )
}

/// Applies the decisions of the command line; an unknown id ends it before anything is changed.
fn by_id(
    arguments: &ReviewArguments,
    found: &mut ReviewItems,
    groups: &[Group],
    pricing: Option<&Pricing>,
    sheets: &mut Sheets,
    io: &Io,
) -> Result<Exit, Failure> {
    let ids = |ids: &[String]| -> Result<BTreeSet<Selection>, Failure> {
        let named = |id: &String| decide::named(id, &found.pending, groups);
        ids.iter().map(named).collect()
    };
    let (accepts, rejects) = (ids(&arguments.accept)?, ids(&arguments.reject)?);
    if let Some(both) = accepts.intersection(&rejects).next() {
        let name = match both {
            Selection::Group(number) => groups[*number].id.clone(),
            Selection::Snapshot(number) => found.pending[*number].name.to_string(),
        };
        return Err(Failure::usage(format!(
            "`{name}` is both accepted and rejected; nothing was done"
        )));
    }
    let mut open_decisions = OpenDecisions::of(found.pending.len(), groups);
    let mut decided: Vec<(usize, Decision)> = Vec::new();
    for (named, decision) in rejects
        .iter()
        .map(|named| (named, Decision::Reject))
        .chain(accepts.iter().map(|named| (named, Decision::Accept)))
    {
        match named {
            Selection::Group(number) => {
                decided.extend(open_decisions.decide(&groups[*number], decision))
            }
            Selection::Snapshot(number) => decided.extend(open_decisions.settle(*number, decision)),
        }
    }
    let all = match arguments.accept_all {
        true => 0..found.pending.len(),
        false => 0..0,
    };
    decided.extend(all.filter_map(|at| open_decisions.settle(at, Decision::Accept)));
    // A text with several edits needs all of them accepted.
    let waiting: Vec<Name> = open_decisions
        .waiting()
        .into_iter()
        .map(|at| found.pending[at].name.clone())
        .collect();
    decide::apply(found, &decided)?;
    let names = |wanted: Decision| -> Vec<Name> {
        decided
            .iter()
            .filter(|(_, decision)| *decision == wanted)
            .map(|(at, _)| found.pending[*at].name.clone())
            .collect()
    };
    let (accepted, rejected) = (names(Decision::Accept), names(Decision::Reject));
    let mut number = 0..;
    found.pending.retain(|_| {
        number
            .next()
            .is_some_and(|at| !decided.iter().any(|(decided, _)| *decided == at))
    });
    if arguments.json {
        let left = groups::group(&found.pending);
        let mut value = as_json(found, &left, pricing, sheets)?;
        value["accepted"] = json!(accepted);
        value["rejected"] = json!(rejected);
        value["waiting"] = json!(waiting);
        io.json(&value);
    } else {
        io.data(&format!(
            "accepted {}, rejected {}, still pending {}",
            accepted.len(),
            rejected.len(),
            found.pending.len()
        ));
        if !waiting.is_empty() {
            io.talk(&format!(
                "{}; give the ids of all of them in one call",
                session::waiting(waiting.len())
            ));
        }
    }
    Ok(Exit::Done)
}

/// Returns the pending snapshots as JSON.
fn as_json(
    found: &ReviewItems,
    groups: &[Group],
    pricing: Option<&Pricing>,
    sheets: &mut Sheets,
) -> Result<Value, Failure> {
    let mut shown = Vec::new();
    for group in groups {
        let members = || group.members.iter().map(|at| &found.pending[*at]);
        let first = members()
            .next()
            .filter(|_| group.kind == Kind::Picture && sheets.has_folder());
        let picture = match first {
            Some(first) => {
                let sheet = sheets.draw(&group.id, first)?;
                let compared = sheet.compared;
                json!({ "path": sheet.path, "changed_pixels": compared.n_changed, "bounds": compared.bounds,
                    "words": compared.words })
            }
            None => Value::Null,
        };
        let edits: Vec<Value> = group
            .edits
            .iter()
            .map(|edit| json!({ "removed": edit.removed, "added": edit.added }))
            .collect();
        let sums = group.tokens.sums();
        shown.push(json!({
            "id": group.id,
            "kind": group.kind,
            "cause": group.causes,
            "edits": edits,
            "tokens": sums.map(|[before, after]| json!({ "before": before, "after": after })),
            "cost": cost::to_json(&group.tokens, pricing),
            "picture": picture,
            "snapshots": members().map(snapshot).collect::<Vec<_>>(),
        }));
    }
    Ok(json!({ "groups": shown, "pending": found.pending.len(), "foreign": found.n_foreign }))
}

fn snapshot(one: &Pending) -> Value {
    json!({
        "id": one.name,
        "path": one.path,
        "task": one.info.task,
        "variant": one.info.variant,
        "stage": one.info.stage,
        "scene": one.info.scene,
        "picture": one.info.picture,
        "file": one.picture_file(),
    })
}
