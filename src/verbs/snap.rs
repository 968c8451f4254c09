//! `fabc snap`: pins the prompts of tasks as files that are reviewed like code.
//!
//! In: `.fab` files. Out: pending snapshots beside them for everything that differs from the accepted ones, all or
//! nothing for each folder. With `--check`: which snapshots differ, wait for review, or belong to nothing, and exit 1.

#[cfg_attr(feature = "runtime", path = "snap/with_camera.rs")]
#[cfg_attr(not(feature = "runtime"), path = "snap/without_camera.rs")]
mod camera;
mod expected;
mod files;
mod origins;
mod pinned;
mod plan;
mod scene;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::shipped;
use crate::sources;
use clap::Args;
use fab_program::Program;
use plan::{Plan, SnapshotState, State};
pub use scene::{Moment, USUAL};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Arguments of `snap`.
#[derive(Args)]
pub struct SnapArguments {
    /// The files whose prompts are pinned.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<String>,
    /// Write nothing; exit 1 if a snapshot differs, waits for review, or is an orphan.
    #[arg(long, conflicts_with_all = ["prune", "scene"])]
    pub check: bool,
    /// Remove accepted snapshots that no file declares any more (orphans).
    #[arg(long)]
    pub prune: bool,
    /// Redraw every picture, even if its inputs are unchanged.
    #[arg(long)]
    pub redraw: bool,
    /// Pin one more scene, under this name; it is kept from then on.
    #[arg(long, value_name = "NAME")]
    pub scene: Option<String>,
    /// Seed of the scene's start, turned or crumpled as the task's is; default: the task's own start.
    #[arg(long, value_name = "SEED", requires = "scene")]
    pub start: Option<u64>,
    /// The step to pin; earlier steps are executed as demonstrated, or as the stand-in decides.
    #[arg(long, value_name = "N", requires = "scene", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub step: u32,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

impl SnapArguments {
    /// Returns the scene to pin in addition to the usual ones.
    pub fn moment(&self) -> Result<Option<Moment>, Failure> {
        let Some(name) = &self.scene else {
            return Ok(None);
        };
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
        if name.is_empty() || !name.chars().all(is_plain) {
            return Err(Failure::usage(format!(
                "`--scene {name}` cannot name a scene; use letters, digits and `_`"
            )));
        }
        if USUAL.contains(&name.as_str()) {
            return Err(Failure::usage(format!(
                "the scene `{name}` is always pinned where a task needs it; choose another name"
            )));
        }
        Ok(Some(Moment {
            name: name.clone(),
            start: self.start,
            step: self.step,
        }))
    }
}

/// A file and what it declares.
pub struct Declared {
    /// The file, in the user's spelling.
    pub file: String,
    /// Its tasks, each followed by its variants.
    pub programs: Vec<Program>,
}

/// Takes snapshots, or reports how they differ.
pub fn run(arguments: &SnapArguments, io: &Io) -> Result<Exit, Failure> {
    if !arguments.check {
        for file in &arguments.files {
            shipped::check_own(file, io)?;
        }
    }
    let mut plans = Vec::new();
    for (folder, declared) in compiled(&arguments.files, io)? {
        let mut plan = Plan::open(&folder)?;
        files::add_expected(&declared, arguments, &mut plan, io)?;
        plans.push(plan);
    }
    // Everything is computed before anything is written, so that a failure leaves every folder unchanged.
    let mut found = Vec::new();
    for plan in &mut plans {
        let mut states = plan.states(io);
        if !arguments.check {
            plan.write(&mut states, arguments)?;
        }
        found.extend(states);
    }
    if arguments.json {
        io.json(&as_json(&found));
    } else {
        report(&found, arguments, io);
    }
    let is_clean = found.iter().all(|found| found.is_clean());
    Ok(match arguments.check && !is_clean {
        true => Exit::Author,
        false => Exit::Done,
    })
}

/// Compiles every file before anything is written, and groups the files by folder.
fn compiled(files: &[String], io: &Io) -> Result<Vec<(PathBuf, Vec<Declared>)>, Failure> {
    let mut folders: BTreeMap<PathBuf, (PathBuf, Vec<Declared>)> = BTreeMap::new();
    let mut failed: Option<Failure> = None;
    for file in files {
        let folder = sources::folder_of(file);
        let shown = match folder.as_os_str().is_empty() {
            true => Path::new("."),
            false => &folder,
        };
        // Two different paths may name the same folder.
        let real = shown.canonicalize().unwrap_or_else(|_| folder.clone());
        let (_, declared) = folders.entry(real).or_insert((folder, Vec::new()));
        let name = Path::new(file).file_name();
        if declared
            .iter()
            .any(|known| Path::new(&known.file).file_name() == name)
        {
            continue;
        }
        let programs = sources::compile_tasks(file, None, io);
        match programs.and_then(|programs| camera::fitted(file, programs, io)) {
            Ok(programs) => declared.push(Declared {
                file: file.clone(),
                programs,
            }),
            Err(failure) => {
                if let Some(earlier) = failed.replace(failure) {
                    io.talk(&format!("error: {earlier}"));
                }
            }
        }
    }
    match failed {
        None => Ok(folders.into_values().collect()),
        Some(failure) => Err(failure.saying("no snapshot was taken")),
    }
}

fn as_json(found: &[SnapshotState]) -> Value {
    let snapshots = found.iter().map(|found| {
        let info = &found.info;
        json!({
            "id": found.name.as_str(),
            "path": found.path.display().to_string(),
            "state": found.state.word(),
            "pending": found.is_pending,
            "task": info.task,
            "variant": info.variant,
            "stage": info.stage,
            "scene": info.scene,
        })
    });
    let count = |state| found.iter().filter(|found| found.state == state).count();
    json!({
        "snapshots": snapshots.collect::<Vec<Value>>(),
        "same": count(State::Same),
        "unseen": count(State::Unchecked),
        "changed": count(State::Changed),
        "new": count(State::New),
        "orphaned": count(State::Orphaned),
        "pending": found.iter().filter(|found| found.is_pending).count(),
    })
}

fn report(found: &[SnapshotState], arguments: &SnapArguments, io: &Io) {
    let counted = |state: State| found.iter().filter(move |found| found.state == state);
    let as_it_was = [State::Same, State::Unchecked];
    for found in found
        .iter()
        .filter(|found| !as_it_was.contains(&found.state))
    {
        io.data(&format!(
            "{:8} {}",
            found.state.word(),
            found.path.display()
        ));
    }
    let [same, changed, new, orphaned] = [State::Same, State::Changed, State::New, State::Orphaned]
        .map(|state| counted(state).count());
    io.talk(&format!(
        "{same} unchanged, {changed} changed, {new} new, {orphaned} orphaned"
    ));
    let unchecked = counted(State::Unchecked).count();
    if unchecked > 0 {
        io.talk(&format!(
            "{unchecked} could not be checked by this build of fabc"
        ));
    }
    let waits = found.iter().filter(|found| found.is_pending).count();
    let places = places(found);
    match arguments.check {
        true if changed + new > 0 => io.talk(&format!(
            "run `fabc snap {}` to write the new snapshots, then `fabc review{places}` to accept or reject them",
            arguments.files.join(" ")
        )),
        true if waits > 0 => io.talk(&format!(
            "{waits} are pending but no longer needed; `fabc snap` removes them"
        )),
        false if waits > 0 => io.talk(&format!(
            "`fabc review{places}` shows what waits, and accepts or rejects it"
        )),
        _ => {}
    }
    if orphaned > 0 && !arguments.prune {
        io.talk(
            "an orphaned snapshot is of something that its file no longer declares; `fabc snap --prune` removes it",
        );
    }
}

/// Returns the snapshot folders outside the current folder, as arguments for `fabc review`.
fn places(found: &[SnapshotState]) -> String {
    let folders: BTreeSet<&Path> = found
        .iter()
        .filter_map(|found| found.path.parent())
        .collect();
    let own = Path::new(crate::snapshots::FOLDER);
    let others = folders.into_iter().filter(|folder| *folder != own);
    others
        .map(|folder| format!(" {}", folder.display()))
        .collect()
}
