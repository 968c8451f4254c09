//! What a finished rollout's folder says.
//!
//! In: a run folder. Out: a [`Record`], or that no rollout has ended there. Tables are made of records alone,
//! whether a rollout was run just now or found finished, so that both give the same figures.

use fab_agent::journal::{JOURNAL_FILE, MAX_SPENT_BYTES, SPENT_FILE};
use fab_agent::operator::Judgement;
use fab_agent::outcome::Outcome;
use fab_agent::rollout::CoverageSource;
use fab_base::{files, npy};
use fab_program::{Goal, Metric as GoalMetric};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// The largest journal and positions that are read.
const MAX_BYTES: u64 = 256 << 20;

/// A rollout that has ended by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// How it ended.
    pub outcome: Outcome,
    /// Its steps, in order; the last may be one that ended it.
    pub steps: Vec<Step>,
    /// What coverage was measured on.
    pub coverage_source: Option<CoverageSource>,
    /// Whether the world knew what the task's goal is judged on.
    pub is_goal_judged: bool,
    /// What the operator said of it, where somebody was asked.
    pub operator: Option<Judgement>,
    /// Where the cloth lay in the end, grid order, world frame, metres; none where nothing was ever executed.
    pub last: Option<Vec<[f32; 3]>>,
}

/// One step of a rollout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// Whether something was executed, or the step was skipped; else the rollout ended in it.
    pub is_taken: bool,
    /// Questions asked.
    pub queries: u32,
    /// Coverage after it by the source measure: SoftGym's grid, or pictures.
    pub coverage: Option<f64>,
    /// Normalized improvement after it by the same measure.
    pub improvement: Option<f64>,
    /// Normalized improvement by the true area after it.
    pub improvement_true: Option<f64>,
    /// Wall time of the whole step, seconds.
    pub seconds: f64,
    /// Wall time of render, vision, prompt, parse and verify, seconds.
    pub planning_s: Option<f64>,
    /// What its answers cost, US dollars; none where a price is not known.
    pub cost_usd: Option<f64>,
}

/// What a rollout is a rollout of; two with the same identity have the same figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Hash of the program.
    pub program: String,
    /// Hash of the world's parameters.
    pub params: String,
    /// Digest of the world's code.
    pub code: String,
    /// Digest of the start.
    pub start: String,
    /// The models of vision and of text, as the header describes them.
    pub models: [Value; 2],
    /// The most actions.
    pub horizon: u32,
    /// Whether a goal that is judged after each step ends it.
    pub early_stop: bool,
    /// Which of the start's rollouts it is.
    pub repetition: u32,
}

/// What a folder holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Found {
    /// Nothing, or a rollout that was cut off, interrupted, or stopped by a cap.
    Unfinished,
    /// A rollout of something else; the text says what differs.
    Other(String),
    /// The rollout.
    Finished(Record),
}

#[derive(Deserialize)]
struct Measured {
    coverage: Option<f64>,
    normalized_improvement: Option<f64>,
    normalized_improvement_true: Option<f64>,
}

/// Reads a run folder.
pub fn find(folder: &Path, wanted: &Identity) -> Found {
    let Ok(bytes) = files::read(&folder.join(JOURNAL_FILE), MAX_BYTES) else {
        return Found::Unfinished;
    };
    let text = String::from_utf8_lossy(&bytes);
    let mut lines = text
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let Some(header) = lines.next() else {
        return Found::Unfinished;
    };
    if let Some(difference) = wanted.difference(&header) {
        return Found::Other(difference);
    }
    let mut steps = Vec::new();
    let mut spent = Spent::read(folder);
    for line in lines {
        match line["type"].as_str() {
            Some("step") => steps.push(step(&line, &mut spent)),
            Some("end") => return ended(folder, &line, steps),
            _ => {}
        }
    }
    Found::Unfinished
}

/// Returns whether a rollout took a step in a folder, or ended there.
pub(super) fn has_steps(folder: &Path) -> bool {
    lines_of(folder).any(|line| line["type"] != "header")
}

/// Returns why the last step of a rollout was not executed, where it was not.
pub(super) fn last_words(folder: &Path) -> Option<String> {
    let steps = lines_of(folder).filter(|line| line["type"] == "step");
    steps.last()?["stopped"].as_str().map(str::to_owned)
}

fn lines_of(folder: &Path) -> impl Iterator<Item = Value> {
    let bytes = files::read(&folder.join(JOURNAL_FILE), MAX_BYTES).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let lines: Vec<Value> = text
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok())
        .collect();
    lines.into_iter()
}

fn ended(folder: &Path, end: &Value, steps: Vec<Step>) -> Found {
    let outcome = serde_json::from_value(end["report"]["outcome"].clone());
    let last = match end["final"].as_str() {
        None => Some(None),
        Some(file) => files::read(&folder.join(file), MAX_BYTES)
            .ok()
            .and_then(|bytes| npy::decode(&bytes))
            .map(Some),
    };
    match (outcome, last) {
        (Ok(Outcome::Interrupted | Outcome::BudgetExhausted), _) => Found::Unfinished,
        (Ok(outcome), Some(last)) => Found::Finished(Record {
            outcome,
            steps,
            // Journals without a source are older than measures by pictures.
            coverage_source: match &end["report"]["coverage_source"] {
                Value::Null if end["report"]["coverage"].is_null() => None,
                Value::Null => Some(CoverageSource::Particles),
                source => CoverageSource::deserialize(source).ok(),
            },
            is_goal_judged: !end["report"]["goal_reached"].is_null(),
            operator: Judgement::deserialize(&end["report"]["operator"]).ok(),
            last,
        }),
        _ => Found::Unfinished,
    }
}

/// What the steps took, by their number.
#[derive(Default)]
struct Spent {
    steps: BTreeMap<u64, Value>,
    cost_usd_so_far: f64,
}

impl Spent {
    /// Reads what a run folder says; of a step that was done again, the first time counts.
    fn read(folder: &Path) -> Spent {
        let bytes = files::read(&folder.join(SPENT_FILE), MAX_SPENT_BYTES).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        let mut spent = Spent::default();
        let lines = text
            .lines()
            .filter_map(|line| serde_json::from_str::<Value>(line).ok());
        for line in lines.filter(|line| line["type"] == "step") {
            if let Some(step) = line["step"].as_u64() {
                spent.steps.entry(step).or_insert(line);
            }
        }
        spent
    }

    /// Returns what a step cost, which comes after those that were asked for before.
    fn cost_usd(&mut self, line: &Value) -> Option<f64> {
        let so_far = line["cost_usd_so_far"].as_f64()?;
        Some(so_far - std::mem::replace(&mut self.cost_usd_so_far, so_far))
    }
}

fn step(line: &Value, spent: &mut Spent) -> Step {
    let took = line["step"]
        .as_u64()
        .and_then(|step| spent.steps.remove(&step))
        .unwrap_or_default();
    let measured = Measured::deserialize(line).ok();
    let of = |get: fn(&Measured) -> Option<f64>| measured.as_ref().and_then(get);
    let seconds = took["seconds"].as_object().into_iter().flatten();
    Step {
        is_taken: !line["executed"].is_null() || !line["skipped"].is_null(),
        queries: line["attempts"]
            .as_array()
            .map_or(0, |all| all.len() as u32),
        coverage: of(|it| it.coverage),
        improvement: of(|it| it.normalized_improvement),
        improvement_true: of(|it| it.normalized_improvement_true),
        seconds: seconds.filter_map(|(_, spent)| spent.as_f64()).sum(),
        planning_s: took["planning_s"].as_f64(),
        cost_usd: spent.cost_usd(&took),
    }
}

impl Identity {
    /// Says in what a journal's header is of another rollout.
    fn difference(&self, header: &Value) -> Option<String> {
        let text = |value: &Value| {
            value
                .as_str()
                .map_or_else(|| value.to_string(), str::to_owned)
        };
        let model = |role: &str| text(&header["models"][role]);
        let pairs = [
            ("program", text(&header["program"]), self.program.clone()),
            ("params", text(&header["params"]), self.params.clone()),
            ("code", text(&header["code"]), self.code.clone()),
            (
                "start",
                text(&header["start"]["digest"]),
                self.start.clone(),
            ),
            ("vision model", model("vision"), text(&self.models[0])),
            ("text model", model("text"), text(&self.models[1])),
            (
                "horizon",
                text(&header["horizon"]),
                self.horizon.to_string(),
            ),
            (
                "early_stop",
                text(&header["early_stop"]),
                self.early_stop.to_string(),
            ),
            (
                "repetition",
                text(&header["repetition"]),
                self.repetition.to_string(),
            ),
        ];
        let different = pairs.into_iter().find(|(_, there, wanted)| there != wanted);
        different.map(|(what, there, wanted)| {
            format!("its {what} is `{there}`, and `{wanted}` is to be run")
        })
    }
}

impl Record {
    /// Returns the steps that count after `horizon` actions.
    ///
    /// With `stop`, those up to and including the first that meets the goal, where that is judged after each step.
    pub fn steps_to(&self, horizon: u32, stop: Option<&Goal>) -> &[Step] {
        let within = &self.steps[..self.steps.len().min(horizon as usize)];
        match stop.and_then(|goal| within.iter().position(|step| meets(goal, step))) {
            Some(at) => &within[..=at],
            None => within,
        }
    }

    /// Returns how the rollout would have ended, had it been given `horizon` actions.
    pub fn outcome_at(&self, horizon: u32, goal: Option<&Goal>, stop: Option<&Goal>) -> Outcome {
        let judged = goal.filter(|goal| goal.metric.is_judged_each_step());
        let steps = self.steps_to(horizon, stop);
        let last = steps.last().filter(|step| step.is_taken);
        if let (Some(goal), Some(last)) = (judged, last)
            && meets(goal, last)
        {
            return Outcome::GoalReached;
        }
        match steps.len() < self.steps.len() {
            true => Outcome::HorizonReached,
            false => self.outcome,
        }
    }
}

/// Returns whether a goal that is judged after each step is met; as in a rollout, by the source measure.
fn meets(goal: &Goal, step: &Step) -> bool {
    let value = match goal.metric {
        GoalMetric::Coverage => step.coverage,
        GoalMetric::NormalizedImprovement => step.improvement,
        GoalMetric::ParticleDistance => None,
    };
    value.is_some_and(|value| goal.is_met(value))
}

#[cfg(test)]
#[path = "record/tests.rs"]
mod tests;
