//! The rollouts beside which the best is shown: the expert, random actions, the stand-in.
//!
//! In: a search. Out: a row each, and the actions of the rollout that ends best. Rollouts are written to run folders.

use crate::exit::Failure;
use crate::io::Io;
use fab_agent::best::{Aim, Choice, Search};
use fab_agent::examples::Examples;
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::{Expert, MakePolicy, Prompted, Random};
use fab_agent::record::{self, Record};
use fab_agent::rollout::{self, Job};
use fab_base::parallel::in_parallel;
use fab_base::{files, npy};
use fab_model::Models;
use fab_model::calls::Budget;
use fab_program::Goal;
use fab_standins::Geometric;
use serde::Serialize;
use std::path::Path;

/// How many rollouts of random actions there are.
const DRAWS: usize = 5;

/// One kind of rollouts.
#[derive(Clone, Debug, Serialize)]
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

/// How a rollout ended.
pub struct End {
    /// The measure of its last state.
    pub value: f64,
    /// Why it has no score, if it has none.
    pub unscored: Option<String>,
    /// What it executed.
    pub actions: Vec<Choice>,
}

impl Row {
    /// Collects rollouts of one kind.
    pub fn of(name: &'static str, oracle: bool, ends: &[End], goal: Option<&Goal>) -> Row {
        let reached = |end: &End| goal.map(|goal| end.unscored.is_none() && goal.is_met(end.value));
        Row {
            name,
            oracle,
            values: ends.iter().map(|end| end.value).collect(),
            reached: ends.iter().filter_map(reached).collect(),
            unscored: ends.iter().filter_map(|end| end.unscored.clone()).collect(),
        }
    }
}

/// Plays the policies beside a search; returns a row each, and the actions of the best rollout with a score.
///
/// - `folder`: where their rollouts are written.
pub fn play(
    search: &Search<'_>,
    aim: &Aim<'_>,
    examples: &Examples,
    folder: &Path,
    io: &Io,
) -> Result<(Vec<Row>, Vec<Choice>), Failure> {
    let seed = search.limits.seed;
    let models = Models {
        vision: &Geometric,
        text: &Geometric,
    };
    let makers: [(&'static str, bool, &dyn MakePolicy, usize); 3] = [
        ("expert", true, &Expert, 1),
        ("random", false, &Random { seed }, DRAWS),
        ("stand-in", false, &Prompted::new(models), 1),
    ];
    let goal = search.program.goal.as_ref();
    let (mut rows, mut scored) = (Vec::new(), Vec::new());
    for (name, oracle, make_policy, count) in makers {
        io.progress(&format!("rollouts beside it: {name}"));
        if let Err(error) = make_policy.make().prepare(search.program) {
            rows.push(Row {
                unscored: vec![error.to_string()],
                ..Row::of(name, oracle, &[], goal)
            });
            continue;
        }
        let play = |index: usize| {
            let job = Job {
                program: search.program,
                start: search.start,
                subgoals: search.subgoals,
                examples,
                make_policy,
                budget: &Budget::default(),
                make_world: search.make_world,
                make_expert_world: search.make_expert_world,
                cache: search.cache,
                interrupt: search.interrupt,
                horizon: Some(search.horizon),
                early_stop: true,
                operator: None,
                repetition: index as u32,
                start_number: None,
            };
            end_of(&job, &folder.join(format!("{name}-{}", index + 1)), aim)
        };
        let ends = in_parallel(count, search.limits.threads, play, |_| {})?;
        let ends: Vec<End> = ends.into_iter().flatten().collect();
        rows.push(Row::of(name, oracle, &ends, goal));
        scored.extend(ends.into_iter().filter(|end| end.unscored.is_none()));
    }
    let loss = |end: &End| aim.measure.loss(end.value);
    let best = scored
        .into_iter()
        .min_by(|a, b| loss(a).total_cmp(&loss(b)));
    Ok((rows, best.map_or(Vec::new(), |end| end.actions)))
}

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
    Ok(Some(End {
        value: aim.value(last).map_err(Failure::environment)?,
        unscored: (!report.outcome.is_scored()).then_some(why),
        actions: record.steps.iter().filter_map(Choice::of).collect(),
    }))
}
