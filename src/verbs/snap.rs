//! `fabc snap`: pins the prompts of tasks as files that are reviewed like code.
//!
//! In: `.fab` files. Out: pending snapshots beside them for everything that differs from the accepted ones. With
//! `--check`: which snapshots differ, wait for review, or belong to nothing, and exit 1.

mod camera;
mod expected;
mod plan;
mod scene;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::shipped;
use crate::snapshots::Name;
use crate::sources;
use clap::Args;
use fab_base::parallel::in_parallel;
use fab_program::Program;
use plan::{Expected, Plan, SnapshotState, State};
use scene::{Moment, USUAL};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::thread;

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
    fn moment(&self) -> Result<Option<Moment>, Failure> {
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
struct Declared {
    /// The file, in the user's spelling.
    file: String,
    /// Its tasks, each followed by its variants.
    programs: Vec<Program>,
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
        let mut plan = Plan::open(&folder, io)?;
        expect(&declared, arguments, &mut plan, io)?;
        plans.push(plan);
    }
    // Everything is computed before anything is written, so that a mistake in one file leaves every folder unchanged.
    let mut found = Vec::new();
    for plan in &plans {
        let mut states = plan.states();
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
    if arguments.check && !is_clean {
        Ok(Exit::Author)
    } else {
        Ok(Exit::Done)
    }
}

/// Adds to a plan what its files should have, one file per core at a time; reports the first file, in their order, that
/// fails.
fn expect(
    declared: &[Declared],
    arguments: &SnapArguments,
    plan: &mut Plan,
    io: &Io,
) -> Result<(), Failure> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let known: &Plan = plan;
    // A failure is a result here, since another file's may come first in their order.
    let look = |index: usize| Ok(Some(of_file(&declared[index], arguments, known, io)));
    let found = in_parallel(declared.len(), threads, look, |_| {});
    let found = found.map_err(|error: std::io::Error| Failure::environment(error))?;
    for (one, found) in declared.iter().zip(found.into_iter().flatten()) {
        plan.expect(&source_of(&one.file), found?)?;
    }
    Ok(())
}

/// Returns the name of a file as its snapshots record it.
fn source_of(file: &str) -> String {
    let name = Path::new(file).file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

fn of_file(
    Declared { file, programs }: &Declared,
    arguments: &SnapArguments,
    plan: &Plan,
    io: &Io,
) -> Result<Vec<(Name, Expected)>, Failure> {
    let mut found = Vec::new();
    // A task and its variants follow each other.
    for programs in programs.chunk_by(|one, other| one.task == other.task) {
        let source = source_of(file);
        found.extend(expected::of_task(
            programs, file, &source, arguments, plan, io,
        )?);
    }
    Ok(found)
}

/// Compiles every file before anything is written, and groups the files by folder.
fn compiled(files: &[String], io: &Io) -> Result<Vec<(PathBuf, Vec<Declared>)>, Failure> {
    let mut folders: BTreeMap<PathBuf, (PathBuf, Vec<Declared>)> = BTreeMap::new();
    let mut failed: Option<Failure> = None;
    for file in files {
        let folder = sources::folder_of(file);
        // Two different paths may name the same folder.
        let real = Path::new(".").join(&folder).canonicalize();
        let real = real.unwrap_or_else(|_| folder.clone());
        let (_, declared) = folders.entry(real).or_insert((folder, Vec::new()));
        let mut known = declared.iter().map(|known| source_of(&known.file));
        if known.any(|known| known == source_of(file)) {
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
            "id": found.name,
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
    if arguments.check && changed + new > 0 {
        io.talk(&format!(
            "run `fabc snap {}` to write the new snapshots, then `fabc review{places}` to accept or reject them",
            arguments.files.join(" ")
        ));
    } else if arguments.check && waits > 0 {
        io.talk(&format!(
            "{waits} are pending but no longer needed; `fabc snap` removes them"
        ));
    } else if waits > 0 {
        io.talk(&format!(
            "`fabc review{places}` shows what waits, and accepts or rejects it"
        ));
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
