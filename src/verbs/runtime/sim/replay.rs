//! `fabc sim replay`: replays recorded demonstrations and compares the results with the recorded ones.
//!
//! Each replay starts from the recorded cloth, and picks and places at the recorded points without a camera. The error
//! is the mean distance between particles of the same index, as in the scoring of folds.

use super::demonstrations::{self, Demonstration};
use super::parallel::{in_parallel, threads};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::sim::parallel::ThreadArguments;
use clap::Args;
use clap::ValueHint;
use fab_base::interrupt::Interrupt;
use fab_sim::{Params, SimError, Simulator};
use fab_world::metrics::mean_particle_distance_m;
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt::Display;
use std::path::PathBuf;
use std::time::Instant;

/// Arguments of `sim replay`.
#[derive(Args)]
pub struct ReplayArguments {
    /// The folder with manifest.json; the manifest's paths begin at the folder above it.
    #[arg(value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub folder: PathBuf,
    /// Only demonstrations with these ids.
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    pub ids: Option<Vec<u64>>,
    /// Only demonstrations of this task, by the recorded data's own name.
    #[arg(long, value_name = "NAME")]
    pub task: Option<String>,
    /// Replace a parameter of the simulator, such as `substeps=8`.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub changes: Vec<String>,
    #[command(flatten)]
    pub threads: ThreadArguments,
    /// List each demonstration, not only each task.
    #[arg(long)]
    pub each: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// The result of one replay.
#[derive(Serialize)]
struct Replayed {
    task: String,
    id: u64,
    /// Mean distance between particles of the same index, millimetres.
    error_mm: f64,
    /// Whether every pick held the same particle as in the recording.
    grasped_as_recorded: bool,
    picks: usize,
    picks_as_recorded: usize,
    steps: u64,
    /// SHA-256 of the final positions' bits.
    digest: String,
}

/// The replays of one task together.
#[derive(Serialize)]
struct Row {
    task: String,
    n: usize,
    mean_mm: f64,
    /// Over the `n` replays, divided by `n` as in NumPy's `std`.
    sd_mm: f64,
    max_mm: f64,
    #[serde(skip)]
    grasps: String,
}

/// Replays the selected demonstrations, and reports.
pub fn run(arguments: &ReplayArguments, io: &Io) -> Result<Exit, Failure> {
    let interrupt = io.interrupt()?;
    let params = params(&arguments.changes)?;
    let wanted = choose(
        demonstrations::read(&arguments.folder)?,
        arguments.task.as_deref(),
        arguments.ids.as_deref(),
    )?;
    // Damaged files should be reported before minutes have passed.
    for demonstration in &wanted {
        let start = demonstration.positions()?.start;
        lay(demonstration, &start, &params)?;
    }
    let n_threads = threads(&arguments.threads).min(wanted.len());
    let (began, total) = (Instant::now(), wanted.len());
    io.progress(&format!("0 of {total} replayed"));
    let results = in_parallel(
        total,
        n_threads,
        |index| replay(&wanted[index], &params, &interrupt),
        |done| io.progress(&format!("{done} of {total} replayed")),
    );
    io.progress("");
    let entries: Vec<Replayed> = results?.into_iter().flatten().collect();
    let steps: u64 = entries.iter().map(|entry| entry.steps).sum();
    io.talk(&format!(
        "{} of {total} replayed, {steps} steps, in {:.1} s on {n_threads} threads",
        entries.len(),
        began.elapsed().as_secs_f64()
    ));
    let rows = rows(&entries);
    if arguments.json {
        io.json(&json!({ "params": params.hash(), "rows": rows, "entries": entries }));
    } else {
        if arguments.each {
            io.data(&table_of_entries(&entries));
        }
        io.data(&table(&rows));
        io.data(&format!("simulator parameters {}", params.hash()));
    }
    Ok(if entries.len() < total {
        Exit::Interrupted
    } else {
        Exit::Done
    })
}

/// Returns the default parameters with the requested changes.
fn params(changes: &[String]) -> Result<Params, Failure> {
    let mut values =
        serde_json::to_value(Params::default()).expect("a struct of numbers is a JSON object");
    for change in changes {
        let wrong = |why: String| Failure::usage(format!("`--set {change}`: {why}"));
        let (name, text) = change
            .split_once('=')
            .ok_or_else(|| wrong("write NAME=VALUE, such as `substeps=8`".to_owned()))?;
        let value: Value = serde_json::from_str(text).map_err(|_| {
            wrong(format!(
                "`{text}` is neither a number nor a list of numbers"
            ))
        })?;
        values[name] = value;
        // Checked after each change, so that the message names the wrong one.
        serde_json::from_value::<Params>(values.clone())
            .map_err(|error| wrong(error.to_string()))?;
    }
    Ok(serde_json::from_value(values).expect("it was read after the last change"))
}

/// Selects the demonstrations that the command line asks for.
pub fn choose(
    mut all: Vec<Demonstration>,
    task: Option<&str>,
    ids: Option<&[u64]>,
) -> Result<Vec<Demonstration>, Failure> {
    if let Some(task) = task {
        let there = listed(all.iter().map(|it| it.task.as_str()));
        all.retain(|it| it.task == task);
        if all.is_empty() {
            return Err(Failure::usage(format!(
                "`--task {task}`: there is no such task; there are {there}"
            )));
        }
    }
    if let Some(ids) = ids {
        if let Some(absent) = ids.iter().find(|id| all.iter().all(|it| it.id != **id)) {
            let there = listed(all.iter().map(|it| it.id));
            return Err(Failure::usage(format!(
                "`--ids`: no demonstration has the id {absent}; there are {there}"
            )));
        }
        all.retain(|it| ids.contains(&it.id));
    }
    Ok(all)
}

/// Lists the available values for a message, sorted and without duplicates; a very long list is cut.
pub fn listed<T: Ord + Display>(values: impl Iterator<Item = T>) -> String {
    const MOST: usize = 50;
    let values: BTreeSet<T> = values.collect();
    let mut names: Vec<String> = values.iter().take(MOST).map(T::to_string).collect();
    if values.len() > MOST {
        names.push(format!("and {} more", values.len() - MOST));
    }
    names.join(", ")
}

/// Lays the cloth of a demonstration.
pub fn lay(it: &Demonstration, start: &[[f32; 3]], params: &Params) -> Result<Simulator, Failure> {
    Simulator::from_positions(it.grid, start, params).map_err(|error| {
        let (task, id) = (&it.task, it.id);
        Failure::environment(format!("the start of `{task}` {id} is no cloth's: {error}"))
    })
}

/// Replays one demonstration; `None` if it was interrupted.
fn replay(
    it: &Demonstration,
    params: &Params,
    interrupt: &Interrupt,
) -> Result<Option<Replayed>, Failure> {
    let positions = it.positions()?;
    let mut cloth = lay(it, &positions.start, params)?;
    let mut picks_as_recorded = 0;
    for pick in &it.picks {
        match cloth.pick_and_place(pick.pick, pick.place, &|| interrupt.is_raised()) {
            Ok(done) => picks_as_recorded += usize::from(done.grasped == Some(pick.particle)),
            Err(SimError::Interrupted { .. }) => return Ok(None),
            Err(error) => {
                return Err(Failure::environment(format!(
                    "`{}` {}: {error}",
                    it.task, it.id
                )));
            }
        }
    }
    let error_m = mean_particle_distance_m(&cloth.positions(), &positions.end)
        .expect("both fill the same grid");
    Ok(Some(Replayed {
        task: it.task.clone(),
        id: it.id,
        error_mm: 1000.0 * error_m,
        grasped_as_recorded: picks_as_recorded == it.picks.len(),
        picks: it.picks.len(),
        picks_as_recorded,
        steps: cloth.steps(),
        digest: cloth.digest(),
    }))
}

/// Summarizes by task, in the order in which tasks first occur.
fn rows(entries: &[Replayed]) -> Vec<Row> {
    let mut tasks: Vec<&str> = Vec::new();
    for entry in entries {
        if !tasks.contains(&entry.task.as_str()) {
            tasks.push(&entry.task);
        }
    }
    let row = |task: &&str| {
        let of_task = || entries.iter().filter(|entry| entry.task == **task);
        let n = of_task().count();
        let mean = |value: &dyn Fn(&Replayed) -> f64| of_task().map(value).sum::<f64>() / n as f64;
        let mean_mm = mean(&|entry| entry.error_mm);
        let as_recorded: usize = of_task().map(|entry| entry.picks_as_recorded).sum();
        let picks: usize = of_task().map(|entry| entry.picks).sum();
        Row {
            task: (*task).to_owned(),
            n,
            mean_mm,
            sd_mm: mean(&|entry| (entry.error_mm - mean_mm).powi(2)).sqrt(),
            max_mm: of_task().map(|entry| entry.error_mm).fold(0.0, f64::max),
            grasps: format!("{as_recorded}/{picks}"),
        }
    };
    tasks.iter().map(row).collect()
}

fn table(rows: &[Row]) -> String {
    let width = rows.iter().map(|row| row.task.len()).max().unwrap_or(0);
    let mut lines = vec![format!(
        "{:<width$} {:>4} {:>9} {:>8} {:>8}   grasped as recorded",
        "task", "n", "mean mm", "sd mm", "max mm"
    )];
    lines.extend(rows.iter().map(|row| {
        format!(
            "{:<width$} {:>4} {:>9.2} {:>8.2} {:>8.2}   {}",
            row.task, row.n, row.mean_mm, row.sd_mm, row.max_mm, row.grasps
        )
    }));
    lines.join("\n")
}

fn table_of_entries(entries: &[Replayed]) -> String {
    let longest = entries.iter().map(|entry| entry.task.len()).max();
    let width = longest.unwrap_or(0);
    let mut lines = vec![format!(
        "{:<width$} {:>4} {:>9} {:>8}   grasped as recorded",
        "task", "id", "error mm", "steps"
    )];
    lines.extend(entries.iter().map(|entry| {
        format!(
            "{:<width$} {:>4} {:>9.2} {:>8}   {}/{}",
            entry.task, entry.id, entry.error_mm, entry.steps, entry.picks_as_recorded, entry.picks
        )
    }));
    lines.join("\n") + "\n"
}
