//! `fabc snap`: pins the prompts of tasks as files that are reviewed like code.
//!
//! In: `.fab` files. Out: pending snapshots beside them for everything that differs from the accepted ones. With
//! `--check`: which snapshots differ, wait for review, or belong to nothing, and exit 1.

mod camera;
mod expected;
mod plan;
pub mod scene;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::{shipped, sources};
use clap::Args;
use expected::Source;
use fab_base::parallel::in_parallel;
use fab_program::Program;
use plan::{Plan, State};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::thread;

#[derive(Args)]
pub struct SnapArguments {
    /// The files whose prompts are pinned.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<String>,
    /// Write nothing; exit 1 if a snapshot differs, waits for review, or is an orphan.
    #[arg(long, conflicts_with = "prune")]
    pub check: bool,
    /// Remove accepted snapshots that no file declares any more (orphans).
    #[arg(long)]
    pub prune: bool,
    /// Redraw every picture, even if its inputs are unchanged.
    #[arg(long)]
    pub redraw: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

pub fn run(arguments: &SnapArguments, io: &Io) -> Result<Exit, Failure> {
    if !arguments.check {
        for file in &arguments.files {
            shipped::check_own(file, io)?;
        }
    }
    // A file that is named twice counts once.
    let mut folders: BTreeMap<PathBuf, BTreeSet<&String>> = BTreeMap::new();
    for file in &arguments.files {
        let files = folders.entry(sources::folder_of(file)).or_default();
        files.insert(file);
    }
    let mut plans = Vec::new();
    for (folder, files) in folders {
        let plan = planned(&folder, &files, arguments, io);
        plans.push(plan.map_err(|failure| failure.saying("no snapshot was taken"))?);
    }
    // Everything is computed before anything is written, so that a mistake in one file leaves every folder unchanged.
    let mut states = Vec::new();
    for plan in &plans {
        let mut found = plan.states();
        if !arguments.check {
            plan.write(&mut found, arguments.prune)?;
        }
        states.extend(found);
    }
    let count = |state: State| states.iter().filter(|it| it.state == state).count();
    let [same, unseen] = [State::Same, State::Unseen].map(count);
    let [changed, new, orphaned] = [State::Changed, State::New, State::Orphaned].map(count);
    let pending = states.iter().filter(|it| it.is_pending).count();
    let document = json!({
        "snapshots": states,
        "same": same,
        "unseen": unseen,
        "changed": changed,
        "new": new,
        "orphaned": orphaned,
        "pending": pending,
    });
    io.either(arguments.json, &document, || {
        let alike = [State::Same, State::Unseen];
        let differing = states.iter().filter(|it| !alike.contains(&it.state));
        let lines = differing.map(|found| {
            let state = format!("{:?}", found.state).to_lowercase();
            format!("{state:8} {}", found.path.display())
        });
        lines.collect::<Vec<String>>().join("\n")
    });
    if !arguments.json {
        let seen = format!("{same} unchanged, {changed} changed, {new} new, {orphaned} orphaned");
        let unseen = match unseen {
            0 => String::new(),
            count => format!(", {count} that this build of fabc cannot check"),
        };
        io.talk(&format!("{seen}{unseen}"));
        let files = arguments.files.join(" ");
        if arguments.check && changed + new + pending > 0 {
            io.talk(&format!(
                "run `fabc snap {files}` to write the new snapshots, then `fabc review {files}` to accept or reject them"
            ));
        } else if pending > 0 {
            io.talk(&format!(
                "`fabc review {files}` shows what waits, and accepts or rejects it"
            ));
        }
        if orphaned > 0 && !arguments.prune {
            io.talk(
                "an orphaned snapshot is of something that its file no longer declares; `fabc snap --prune` removes it",
            );
        }
    }
    Ok(
        if arguments.check && changed + new + orphaned + pending > 0 {
            Exit::Author
        } else {
            Exit::Done
        },
    )
}

/// Compiles the files of a folder, and finds what snapshots they should have, one file per core at a time.
fn planned(
    folder: &Path,
    files: &BTreeSet<&String>,
    arguments: &SnapArguments,
    io: &Io,
) -> Result<Plan, Failure> {
    let mut declared: Vec<(String, Vec<Program>)> = Vec::new();
    for file in files {
        let programs = sources::compile_tasks(file, None, None, io)?;
        let name = Path::new(file).file_name().unwrap_or_default();
        let name = name.to_string_lossy().into_owned();
        declared.push((name, camera::fitted(file, programs, io)?));
    }
    let mut plan = Plan::open(folder, io)?;
    let expected = |number: usize| {
        let (name, programs) = &declared[number];
        let source = Source { name, folder };
        expected::of_file(programs, &source, arguments.redraw, &plan, io).map(Some)
    };
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let found = in_parallel(declared.len(), threads, expected, |_| {})?;
    for ((name, _), found) in declared.iter().zip(found.into_iter().flatten()) {
        plan.expect(name, found)?;
    }
    Ok(plan)
}
