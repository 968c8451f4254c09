//! `fabc snap`: pins what tasks say to models, as files that are reviewed like code.
//!
//! In: `.fab` files. Out: pending snapshots beside them for whatever differs from the accepted ones, all or nothing for
//! each folder; or with `--check`, which snapshots differ, wait, or belong to nothing, and exit 1.

#[cfg_attr(feature = "runtime", path = "snap/with_camera.rs")]
#[cfg_attr(not(feature = "runtime"), path = "snap/without_camera.rs")]
mod camera;
mod expected;
mod files;
mod origins;
mod pinned;
mod plan;
mod scene;

use crate::cli::snap::SnapArguments;
use crate::exit::{Exit, Failure};
use crate::{output, sources};
use fab_program::Program;
use plan::{Found, Plan, State};
pub use scene::{Moment, USUAL};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A file and what it declares.
pub struct Declared {
    /// The file, as the user named it.
    pub file: String,
    /// Its tasks, each followed by its variants.
    pub programs: Vec<Program>,
}

/// Takes snapshots, or says how they differ.
pub fn run(arguments: &SnapArguments) -> Result<Exit, Failure> {
    let mut plans = Vec::new();
    for (folder, declared) in compiled(&arguments.files)? {
        let mut plan = Plan::open(&folder)?;
        files::want(&declared, arguments, &mut plan)?;
        plans.push(plan);
    }
    // Nothing is written before all of it is known, so that what fails leaves every folder as it was.
    let mut found = Vec::new();
    for plan in &mut plans {
        let mut states = plan.states();
        if !arguments.check {
            plan.carry_out(&mut states, arguments)?;
        }
        found.extend(states);
    }
    if arguments.json {
        output::json(&as_json(&found));
    } else {
        report(&found, arguments);
    }
    let is_clean = found.iter().all(|found| found.is_clean());
    Ok(match arguments.check && !is_clean {
        true => Exit::Author,
        false => Exit::Done,
    })
}

/// Compiles every file before anything is written, and puts those of one folder together.
fn compiled(files: &[String]) -> Result<Vec<(PathBuf, Vec<Declared>)>, Failure> {
    let mut folders: BTreeMap<PathBuf, (PathBuf, Vec<Declared>)> = BTreeMap::new();
    let mut failed: Option<Failure> = None;
    for file in files {
        let folder = sources::folder_of(file);
        let shown = match folder.as_os_str().is_empty() {
            true => Path::new("."),
            false => &folder,
        };
        // One folder may be named in two ways.
        let real = shown.canonicalize().unwrap_or_else(|_| folder.clone());
        let (_, declared) = folders.entry(real).or_insert((folder, Vec::new()));
        let name = Path::new(file).file_name();
        if declared
            .iter()
            .any(|known| Path::new(&known.file).file_name() == name)
        {
            continue;
        }
        let programs = sources::compile_tasks(file, None);
        match programs.and_then(|programs| camera::fitted(file, programs)) {
            Ok(programs) => declared.push(Declared {
                file: file.clone(),
                programs,
            }),
            Err(failure) => {
                if let Some(earlier) = failed.replace(failure) {
                    output::talk(&format!("error: {earlier}"));
                }
            }
        }
    }
    match failed {
        None => Ok(folders.into_values().collect()),
        Some(failure) => Err(failure.saying("no snapshot was taken")),
    }
}

fn as_json(found: &[Found]) -> Value {
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
        "unseen": count(State::Unseen),
        "changed": count(State::Changed),
        "new": count(State::New),
        "orphaned": count(State::Orphaned),
        "pending": found.iter().filter(|found| found.is_pending).count(),
    })
}

fn report(found: &[Found], arguments: &SnapArguments) {
    let counted = |state: State| found.iter().filter(move |found| found.state == state);
    let as_it_was = [State::Same, State::Unseen];
    for found in found
        .iter()
        .filter(|found| !as_it_was.contains(&found.state))
    {
        output::data(&format!(
            "{:8} {}",
            found.state.word(),
            found.path.display()
        ));
    }
    let [same, changed, new, orphaned] = [State::Same, State::Changed, State::New, State::Orphaned]
        .map(|state| counted(state).count());
    output::talk(&format!(
        "{same} as accepted, {changed} changed, {new} new, {orphaned} orphaned"
    ));
    let unseen = counted(State::Unseen).count();
    if unseen > 0 {
        output::talk(&format!(
            "{unseen} were not looked at by this build of fabc"
        ));
    }
    let waits = found.iter().filter(|found| found.is_pending).count();
    let places = places(found);
    match arguments.check {
        true if changed + new > 0 => output::talk(&format!(
            "`fabc snap {}` proposes what is new, `fabc review{places}` shows it and accepts or rejects it",
            arguments.files.join(" ")
        )),
        true if waits > 0 => output::talk(&format!(
            "{waits} are pending and no longer needed; `fabc snap` takes them away"
        )),
        false if waits > 0 => output::talk(&format!(
            "`fabc review{places}` shows what waits, and accepts or rejects it"
        )),
        _ => {}
    }
    if orphaned > 0 && !arguments.prune {
        output::talk(
            "an orphaned snapshot is of something that its file no longer declares; `fabc snap --prune` removes it",
        );
    }
}

/// Returns the folders of snapshots that are not below the current one's own, as arguments for `fabc review`.
fn places(found: &[Found]) -> String {
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
