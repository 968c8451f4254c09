//! The rollouts beside which the best is shown: the expert, random actions, the stand-in.
//!
//! In: a rollout's job, whose policy is replaced. Out: a row each, and the actions of the rollout that ends best. Rollouts are written to run folders.

use crate::exit::Failure;
use crate::io::Io;
use fab_agent::best::{Aim, Choice, Limits};
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::{Expert, MakePolicy, Prompted, Random};
use fab_agent::record::{self, Record};
use fab_agent::rollout::{self, Job};
use fab_base::parallel::in_parallel;
use fab_base::{files, npy};
use fab_bench::statistics;
use fab_model::Models;
use fab_program::Goal;
use fab_standins::Geometric;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::Path;

/// How many rollouts of random actions there are.
const DRAWS: usize = 5;

/// One kind of rollouts.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Row {
    #[serde(rename = "row")]
    pub name: &'static str,
    /// Whether it may look at the true state of the cloth, which no camera shows.
    pub oracle: bool,
    /// The measure at the end of each rollout, however it ended.
    pub values: Vec<f64>,
    /// Whether each of these reached the goal; empty without one.
    pub reached: Vec<bool>,
    /// Why each rollout without a score has none.
    pub unscored: Vec<String>,
}

impl Row {
    /// Adds a rollout by its measure, and why it has no score, if it has none.
    pub fn add(&mut self, value: f64, unscored: Option<String>, goal: Option<&Goal>) {
        self.values.push(value);
        let is_scored = unscored.is_none();
        self.reached
            .extend(goal.map(|goal| is_scored && goal.is_met(value)));
        self.unscored.extend(unscored);
    }

    /// Returns the cells of its line in a table; `shown` writes a measure.
    pub fn cells(&self, shown: impl Fn(f64) -> String) -> [String; 3] {
        let oracle = if self.oracle { " (oracle)" } else { "" };
        let mean = statistics::mean(&self.values);
        let mut notes = Vec::new();
        if self.values.len() > 1 {
            notes.push(format!("mean of {} rollouts", self.values.len()));
        }
        if !self.reached.is_empty() {
            let reached = self.reached.iter().filter(|it| **it).count();
            notes.push(format!(
                "{reached} of {} reach the goal",
                self.reached.len()
            ));
        }
        let measured = mean.map_or("", |_| ", measured at its end");
        let whys: BTreeSet<&String> = self.unscored.iter().collect();
        notes.extend(whys.iter().map(|why| format!("no score ({why}){measured}")));
        let mean = mean.map_or("none".to_owned(), shown);
        [format!("{}{oracle}", self.name), mean, notes.join("; ")]
    }
}

/// Plays the policies; returns a row each, and the actions of the best rollout with a score.
///
/// - `folder`: where their rollouts are written.
pub fn play(
    job: &Job<'_>,
    limits: &Limits,
    aim: &Aim<'_>,
    folder: &Path,
    io: &Io,
) -> Result<(Vec<Row>, Vec<Choice>), Failure> {
    let seed = limits.seed;
    let models = Models {
        vision: &Geometric,
        text: &Geometric,
    };
    let makers: [(&'static str, bool, &dyn MakePolicy, usize); 3] = [
        ("expert", true, &Expert, 1),
        ("random", false, &Random { seed }, DRAWS),
        ("stand-in", false, &Prompted::new(models), 1),
    ];
    let (mut rows, mut scored) = (Vec::new(), Vec::new());
    for (name, oracle, make_policy, count) in makers {
        io.progress(&format!("rollouts beside it: {name}"));
        let mut row = Row {
            name,
            oracle,
            ..Row::default()
        };
        if let Err(error) = make_policy.make().prepare(job.program) {
            row.unscored.push(error.to_string());
            rows.push(row);
            continue;
        }
        let play = |index: usize| {
            let job = Job {
                make_policy,
                repetition: index as u32,
                ..*job
            };
            end_of(&job, &folder.join(format!("{name}-{}", index + 1)), aim)
        };
        let ends = in_parallel(count, limits.threads, play, |_| {})?;
        for (value, unscored, actions) in ends.into_iter().flatten() {
            if unscored.is_none() {
                scored.push((aim.loss(value), actions));
            }
            row.add(value, unscored, job.program.goal.as_ref());
        }
        rows.push(row);
    }
    let best = scored.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    Ok((rows, best.map_or(Vec::new(), |(_, actions)| actions)))
}

/// The measure of a rollout's last state, why it has no score, and what it executed.
type End = (f64, Option<String>, Vec<Choice>);

/// Plays one rollout; `None` if it was interrupted.
fn end_of(job: &Job<'_>, folder: &Path, aim: &Aim<'_>) -> Result<Option<End>, Failure> {
    let report = match rollout::run(job, RunFolder::create(folder)?, &mut |_| {}) {
        Ok(ended) => ended.report,
        Err(_) if job.interrupt.is_raised() => return Ok(None),
        Err(error) => return Err(Failure::environment(error)),
    };
    if report.outcome == Outcome::Interrupted {
        return Ok(None);
    }
    let why = report.stopped.as_deref();
    let why = why.unwrap_or(report.outcome.name()).to_owned();
    let record = Record::read(folder).map_err(Failure::environment)?;
    let last = record.end.and_then(|end| end.final_positions);
    let last = last.and_then(|file| files::read(&folder.join(file), record::MAX_BYTES).ok());
    let last = last.and_then(|bytes| npy::decode(&bytes));
    let last = last.as_ref().unwrap_or(&job.start.positions);
    let value = aim.value(last).map_err(Failure::environment)?;
    let unscored = (!report.outcome.is_scored()).then_some(why);
    let actions = record.steps.iter().filter_map(Choice::of).collect();
    Ok(Some((value, unscored, actions)))
}
