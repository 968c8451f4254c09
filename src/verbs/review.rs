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
use crate::snapshots::Name;
use crate::verbs::price::Price;
use clap::Args;
use decide::{Decision, Decisions, Selection};
use find::{Pending, ReviewItems};
use groups::{Group, Kind};
use pictures::Sheets;
use serde_json::{Value, json};
use session::Session;
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
    #[cfg(feature = "runtime")]
    #[command(flatten)]
    pub shown: ShownArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// What is shown of a change beside its text.
#[cfg(feature = "runtime")]
#[derive(Args)]
pub struct ShownArguments {
    /// Print what the change costs with this `PROVIDER:NAME`.
    #[arg(long, value_name = "MODEL")]
    pub model: Option<String>,
    #[command(flatten)]
    pub facts: crate::verbs::runtime::setting::catalogue::FactsArguments,
    /// Write the pictures before and after, and their difference, into this folder; default: a temporary one, when they are shown.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl ReviewArguments {
    /// Returns what the named model costs, if there is one; fails if its price is not known.
    #[cfg(feature = "runtime")]
    fn price(&self, io: &Io) -> Result<Option<Price>, Failure> {
        use crate::verbs::runtime::setting::catalogue;
        let Some(model) = &self.shown.model else {
            return Ok(None);
        };
        let profile = catalogue::profile(model, self.shown.facts.models.as_deref(), io)?;
        let price = Price::of(profile, io);
        if (price.nano_usd)(1).is_none() {
            return Err(Failure::usage(format!(
                "the price of `{model}` is not known; say it in a file of facts (--models)"
            )));
        }
        Ok(Some(price))
    }

    /// Returns `None`: the authoring tool knows no prices.
    #[cfg(not(feature = "runtime"))]
    fn price(&self, _io: &Io) -> Result<Option<Price>, Failure> {
        Ok(None)
    }

    /// Returns the folder that is named for pictures.
    fn sheets(&self) -> Option<PathBuf> {
        #[cfg(feature = "runtime")]
        return self.shown.out.clone();
        #[cfg(not(feature = "runtime"))]
        None
    }
}

/// Reviews the pending snapshots.
pub fn run(arguments: &ReviewArguments, io: &Io) -> Result<Exit, Failure> {
    let ReviewItems {
        mut pending,
        n_foreign,
    } = find::find(&arguments.places)?;
    if let Some(part) = &arguments.only {
        pending.retain(|one| one.name.0.contains(part));
    }
    for why in pending.iter().filter_map(|one| one.unreadable.as_ref()) {
        io.talk(&format!("counted as new: {why}"));
    }
    let groups = groups::group(&pending);
    let price = arguments.price(io)?;
    let mut sheets = Sheets {
        folder: arguments.sheets(),
    };
    let decides =
        arguments.accept_all || !arguments.accept.is_empty() || !arguments.reject.is_empty();
    if decides {
        let [accepted, rejected, waiting] = by_id(arguments, &mut pending, &groups)?;
        if arguments.json {
            let left = groups::group(&pending);
            let mut value = as_json(&pending, n_foreign, &left, price.as_ref(), &mut sheets)?;
            value["accepted"] = json!(accepted);
            value["rejected"] = json!(rejected);
            value["waiting"] = json!(waiting);
            io.json(&value);
            return Ok(Exit::Done);
        }
        io.data(&format!(
            "accepted {}, rejected {}, still pending {}",
            accepted.len(),
            rejected.len(),
            pending.len()
        ));
        if !waiting.is_empty() {
            io.talk(&format!(
                "{}; give the ids of all of them in one call",
                session::waiting(waiting.len())
            ));
        }
        return Ok(Exit::Done);
    }
    if arguments.json {
        let value = as_json(&pending, n_foreign, &groups, price.as_ref(), &mut sheets)?;
        io.json(&value);
        return Ok(Exit::Done);
    }
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
    Session::of(&pending, &groups, price.as_ref(), &mut sheets).run(io)
}

/// Applies the decisions of the command line; an unknown id ends it before anything is changed.
///
/// Returns the names of the accepted and the rejected snapshots, which are no longer pending, and of those that wait for
/// decisions about their other edits.
fn by_id(
    arguments: &ReviewArguments,
    pending: &mut Vec<Pending>,
    groups: &[Group],
) -> Result<[Vec<Name>; 3], Failure> {
    let mut decisions = Decisions::about(groups);
    let accepts = arguments.accept.iter().map(|id| (id, Decision::Accept));
    let rejects = arguments.reject.iter().map(|id| (id, Decision::Reject));
    for (id, decision) in accepts.chain(rejects) {
        let named = decide::named(id, pending, groups)?;
        let earlier = decisions.decide(named, decision);
        if earlier.is_some_and(|earlier| earlier != decision) {
            return Err(Failure::usage(format!(
                "`{id}` is both accepted and rejected; nothing was done"
            )));
        }
    }
    if arguments.accept_all {
        for at in 0..pending.len() {
            if decisions.of(at).is_none() {
                decisions.decide(Selection::Snapshot(at), Decision::Accept);
            }
        }
    }
    let mut names = [const { Vec::new() }; 3];
    let mut left = Vec::new();
    for (at, one) in pending.drain(..).enumerate() {
        match decisions.of(at) {
            Some(decision) => {
                decide::apply(&one, decision)?;
                names[decision as usize].push(one.name);
            }
            None => {
                if decisions.is_waiting(at) {
                    names[2].push(one.name.clone());
                }
                left.push(one);
            }
        }
    }
    *pending = left;
    Ok(names)
}

/// Returns the pending snapshots as JSON.
fn as_json(
    pending: &[Pending],
    n_foreign: usize,
    groups: &[Group],
    price: Option<&Price>,
    sheets: &mut Sheets,
) -> Result<Value, Failure> {
    let mut shown = Vec::new();
    for group in groups {
        let members = || group.members.iter().map(|at| &pending[*at]);
        let has_picture = group.kind == Kind::Picture && sheets.folder.is_some();
        let picture = match members().next().filter(|_| has_picture) {
            Some(first) => sheets.draw(&group.id, first)?.to_json(),
            None => Value::Null,
        };
        let edits = group.edits.iter();
        let edits = edits.map(|edit| json!({ "removed": edit.removed, "added": edit.added }));
        let tokens = group.all_tokens();
        let cost = tokens.zip(price).map(|(tokens, price)| {
            let [before, after] = tokens.map(|tokens| usd(price, tokens));
            json!({ "model": price.model, "before_usd": before, "after_usd": after })
        });
        shown.push(json!({
            "id": group.id,
            "kind": group.kind,
            "cause": group.causes,
            "edits": Value::from_iter(edits),
            "tokens": tokens.map(|[before, after]| json!({ "before": before, "after": after })),
            "cost": cost,
            "picture": picture,
            "snapshots": Value::from_iter(members().map(snapshot)),
        }));
    }
    Ok(json!({ "groups": shown, "pending": pending.len(), "foreign": n_foreign }))
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

/// Returns the price of so many tokens, US dollars; [`ReviewArguments::price`] made sure that it is known.
fn usd(price: &Price, tokens: u64) -> f64 {
    (price.nano_usd)(tokens).unwrap_or_default() as f64 / 1e9
}

/// Describes the change of a group's questions in tokens and in money; `None` if it has none.
fn cost_in_words(group: &Group, price: Option<&Price>) -> Option<String> {
    let [before, after] = group.all_tokens()?;
    let questions = group.tokens.iter();
    let changes = questions.map(|[before, after]| *after as i64 - *before as i64);
    let (least, most) = (changes.clone().min()?, changes.max()?);
    let range = |in_words: &dyn Fn(i64) -> String| {
        if least == most {
            in_words(least)
        } else {
            format!("{} to {}", in_words(least), in_words(most))
        }
    };
    let mut words = format!(
        "tokens (estimated): {} per question",
        range(&|tokens| format!("{tokens:+}"))
    );
    let count = group.tokens.len();
    if count > 1 {
        let sum = after as i64 - before as i64;
        words.push_str(&format!(", {sum:+} over {count} questions"));
    }
    words.push_str(&match price {
        Some(price) => {
            let each = range(&|tokens| {
                let sign = if tokens < 0 { '-' } else { '+' };
                format!("{sign}{:.7} USD", usd(price, tokens.unsigned_abs()))
            });
            format!(
                "\ncost (estimated): {each} per question with {}",
                price.model
            )
        }
        None if cfg!(feature = "runtime") => {
            "\nfor the cost, add `--model PROVIDER:NAME`".to_owned()
        }
        None => "\nthis build knows no prices".to_owned(),
    });
    Some(words)
}
