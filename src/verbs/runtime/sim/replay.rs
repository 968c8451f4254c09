//! `fabc sim replay`: replays recorded demonstrations and compares the results with the recorded ones.
//!
//! Each replay picks and places at the recorded points without a camera. The error is the mean distance between
//! particles of the same index, as in the scoring of folds.

use super::demonstrations::{self, Demonstration};
use super::{ThreadArguments, each};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::{Args, ValueHint};
use fab_base::interrupt::Interrupt;
use fab_base::table::{Align, aligned};
use fab_bench::statistics::{mean, standard_deviation};
use fab_sim::{Params, SimError};
use fab_world::metrics::mean_particle_distance_m;
use serde::Serialize;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::PathBuf;

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
    #[command(flatten)]
    pub threads: ThreadArguments,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize)]
struct Replayed {
    task: String,
    id: u64,
    error_mm: f64,
    grasped_as_recorded: bool,
    picks: usize,
    picks_as_recorded: usize,
    steps: u64,
    digest: String,
}

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

pub fn run(arguments: &ReplayArguments, io: &Io) -> Result<Exit, Failure> {
    let interrupt = io.interrupt()?;
    let params = Params::default();
    let (task, ids) = (arguments.task.as_deref(), arguments.ids.as_deref());
    let selected = demonstrations::read(&arguments.folder, task, ids)?;
    let play = |index: usize| replay(&selected[index], &params, &interrupt);
    let entries = each(selected.len(), &arguments.threads, "replayed", io, play)?;
    let mut by_task: BTreeMap<&str, Vec<&Replayed>> = BTreeMap::new();
    for entry in &entries {
        by_task.entry(&entry.task).or_default().push(entry);
    }
    let params = params.hash();
    let rows: Vec<Row> = by_task.into_values().map(Row::of).collect();
    let document = json!({ "params": params, "rows": rows, "entries": entries });
    io.either(arguments.json, &document, || text(&rows, &params));
    Ok(Exit::Done)
}

fn replay(it: &Demonstration, params: &Params, interrupt: &Interrupt) -> Result<Replayed, Failure> {
    let (mut cloth, end) = it.laid(params)?;
    let mut picks_as_recorded = 0;
    for step in &it.steps {
        let [pick, place] = step.ends_m();
        let as_recorded = |particle| particle == it.held(step);
        match cloth.pick_and_place(pick, place, &|| interrupt.is_raised()) {
            Ok(done) => picks_as_recorded += usize::from(done.grasped.is_some_and(as_recorded)),
            Err(SimError::Interrupted { .. }) => return Err(Failure::interrupted()),
            Err(error) => return Err(it.failure(error)),
        }
    }
    let error_m = mean_particle_distance_m(&cloth.positions(), &end);
    Ok(Replayed {
        task: it.task.clone(),
        id: it.id,
        error_mm: 1000.0 * error_m.expect("both fill the same grid"),
        grasped_as_recorded: picks_as_recorded == it.steps.len(),
        picks: it.steps.len(),
        picks_as_recorded,
        steps: cloth.steps(),
        digest: cloth.digest(),
    })
}

impl Row {
    fn of(entries: Vec<&Replayed>) -> Row {
        let errors_mm: Vec<f64> = entries.iter().map(|entry| entry.error_mm).collect();
        let sum = |of: fn(&Replayed) -> usize| entries.iter().map(|it| of(it)).sum::<usize>();
        let (as_recorded, picks) = (sum(|it| it.picks_as_recorded), sum(|it| it.picks));
        Row {
            task: entries[0].task.clone(),
            n: entries.len(),
            mean_mm: mean(&errors_mm).unwrap_or_default(),
            sd_mm: standard_deviation(&errors_mm).unwrap_or_default(),
            max_mm: errors_mm.into_iter().fold(0.0, f64::max),
            grasps: format!("{as_recorded}/{picks}"),
        }
    }
}

fn text(rows: &[Row], params: &str) -> String {
    let titles = "task,n,mean mm,sd mm,max mm,grasped as recorded";
    let mut table = vec![titles.split(',').map(str::to_owned).collect()];
    table.extend(rows.iter().map(|row| {
        let [mean, sd, max] = [row.mean_mm, row.sd_mm, row.max_mm].map(|mm| format!("{mm:.2}"));
        let [task, grasps] = [&row.task, &row.grasps].map(String::clone);
        vec![task, row.n.to_string(), mean, sd, max, grasps]
    }));
    use Align::{Left, Right};
    let lines = aligned(&[Left, Right, Right, Right, Right], &table).join("\n");
    format!("{lines}\nsimulator parameters {params}")
}
