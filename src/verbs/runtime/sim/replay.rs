//! `fabc sim replay`: replays recorded demonstrations and compares the results with the recorded ones.
//!
//! Each replay starts from the recorded cloth, and picks and places at the recorded points without a camera. The error
//! is the mean distance between particles of the same index, as in the scoring of folds.

use super::demonstrations::{self, Demonstration};
use super::parallel::{ThreadArguments, in_parallel, threads};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use clap::{Args, ValueHint};
use fab_base::interrupt::Interrupt;
use fab_base::table::{Align, aligned};
use fab_sim::{Params, SimError};
use fab_world::metrics::mean_particle_distance_m;
use serde::Serialize;
use serde_json::Value;
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
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// All replays.
#[derive(Serialize)]
struct Replays {
    params: String,
    rows: Vec<Row>,
    entries: Vec<Replayed>,
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
    let ids = arguments.ids.as_deref();
    let wanted = demonstrations::read(&arguments.folder, arguments.task.as_deref(), ids)?;
    // Damaged files should be reported before minutes have passed.
    for demonstration in &wanted {
        demonstration.lay(&demonstration.positions()?.start, &params)?;
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
    let replays = Replays {
        params: params.hash(),
        rows: rows(&entries),
        entries,
    };
    io.result(arguments.json, &replays);
    Ok(if replays.entries.len() < total {
        Exit::Interrupted
    } else {
        Exit::Done
    })
}

/// Returns the default parameters with the requested changes.
fn params(changes: &[String]) -> Result<Params, Failure> {
    let mut params = Params::default();
    for change in changes {
        let wrong = |why: String| Failure::usage(format!("`--set {change}`: {why}"));
        let (name, text) = change
            .split_once('=')
            .ok_or_else(|| wrong("write NAME=VALUE, such as `substeps=8`".to_owned()))?;
        let mut values = serde_json::to_value(&params).expect("a struct of numbers is an object");
        values[name] = serde_json::from_str::<Value>(text).map_err(|_| {
            wrong(format!(
                "`{text}` is neither a number nor a list of numbers"
            ))
        })?;
        params = serde_json::from_value(values).map_err(|error| wrong(error.to_string()))?;
    }
    Ok(params)
}

/// Replays one demonstration; `None` if it was interrupted.
fn replay(
    it: &Demonstration,
    params: &Params,
    interrupt: &Interrupt,
) -> Result<Option<Replayed>, Failure> {
    let positions = it.positions()?;
    let mut cloth = it.lay(&positions.start, params)?;
    let mut picks_as_recorded = 0;
    for pick in &it.picks {
        match cloth.pick_and_place(pick.pick, pick.place, &|| interrupt.is_raised()) {
            Ok(done) => picks_as_recorded += usize::from(done.grasped == Some(pick.particle)),
            Err(SimError::Interrupted { .. }) => return Ok(None),
            Err(error) => return Err(Failure::environment(format!("{it}: {error}"))),
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
    let mut by_task: Vec<Vec<&Replayed>> = Vec::new();
    for entry in entries {
        match by_task.iter_mut().find(|it| it[0].task == entry.task) {
            Some(of_task) => of_task.push(entry),
            None => by_task.push(vec![entry]),
        }
    }
    let row = |of_task: &Vec<&Replayed>| {
        let n = of_task.len();
        let errors_mm = || of_task.iter().map(|entry| entry.error_mm);
        let mean_mm = errors_mm().sum::<f64>() / n as f64;
        let squares: f64 = errors_mm().map(|error| (error - mean_mm).powi(2)).sum();
        let as_recorded: usize = of_task.iter().map(|entry| entry.picks_as_recorded).sum();
        let picks: usize = of_task.iter().map(|entry| entry.picks).sum();
        Row {
            task: of_task[0].task.clone(),
            n,
            mean_mm,
            sd_mm: (squares / n as f64).sqrt(),
            max_mm: errors_mm().fold(0.0, f64::max),
            grasps: format!("{as_recorded}/{picks}"),
        }
    };
    by_task.iter().map(row).collect()
}

impl Report for Replays {
    fn text(&self) -> String {
        use Align::{Left, Right};
        let heading = [
            "task",
            "n",
            "mean mm",
            "sd mm",
            "max mm",
            "grasped as recorded",
        ];
        let mut table = vec![heading.map(str::to_owned)];
        table.extend(self.rows.iter().map(|row| {
            let [mean, sd, max] = [row.mean_mm, row.sd_mm, row.max_mm].map(|mm| format!("{mm:.2}"));
            [
                row.task.clone(),
                row.n.to_string(),
                mean,
                sd,
                max,
                row.grasps.clone(),
            ]
        }));
        let mut lines = aligned(&[Left, Right, Right, Right, Right, Left], &table);
        lines.push(format!("simulator parameters {}", self.params));
        lines.join("\n")
    }
}
