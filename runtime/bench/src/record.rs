//! What a finished rollout's folder says.
//!
//! In: a run folder. Out: a [`Rollout`], or that no rollout has ended there. Tables are made of run folders alone,
//! whether a rollout was run just now or found finished, so that both give the same figures.

use fab_agent::outcome::Outcome;
use fab_agent::policy;
use fab_agent::record::{self, Header, MAX_BYTES, Record, RecordError, Report, StepSpent};
use fab_base::{files, npy};
use fab_program::{Goal, Metric as GoalMetric};
use serde_json::Value;
use std::path::Path;

/// A rollout that has ended by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Rollout {
    /// What came of it.
    pub report: Report,
    /// Its steps, in order; the last may be one that ended it.
    pub steps: Vec<Step>,
    /// Where the cloth lay in the end, grid order, world frame, metres; none where nothing was ever executed.
    pub last: Option<Vec<[f32; 3]>>,
}

/// One step of a rollout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// What was asked, done and measured.
    pub line: record::Step,
    /// What it took.
    pub spent: StepSpent,
    /// What its answers cost, US dollars; none where a price is not known.
    pub cost_usd: Option<f64>,
}

impl Step {
    /// Returns the wall time of the whole step, seconds.
    pub fn seconds(&self) -> f64 {
        self.spent.seconds.values().filter_map(Value::as_f64).sum()
    }
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
    /// Who decides.
    pub policy: policy::Description,
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
    Finished(Box<Rollout>),
}

/// Reads a run folder.
pub fn find(folder: &Path, wanted: &Identity) -> Found {
    let read = match Record::read(folder) {
        Ok(read) => read,
        Err(RecordError::Absent(_)) => return Found::Unfinished,
        // Done again, it would be read again as it is now.
        Err(error) => return Found::Other(error.to_string()),
    };
    if let Some(difference) = wanted.difference(&read.header) {
        return Found::Other(difference);
    }
    let Some(end) = read.end else {
        return Found::Unfinished;
    };
    if matches!(
        end.report.outcome,
        Outcome::Interrupted | Outcome::BudgetExhausted
    ) {
        return Found::Unfinished;
    }
    let last = match &end.final_positions {
        None => None,
        Some(file) => match positions(&folder.join(file)) {
            Some(positions) => Some(positions),
            None => return Found::Unfinished,
        },
    };
    let mut spent = read.spent;
    let mut cost_usd_before = 0.0;
    let steps = read.steps.into_iter().map(|line| {
        let spent = spent.remove(&line.step).unwrap_or_default();
        // A step's cost comes after those that were asked for before.
        let cost_usd = spent
            .cost_usd_so_far
            .map(|so_far| so_far - std::mem::replace(&mut cost_usd_before, so_far));
        Step {
            line,
            spent,
            cost_usd,
        }
    });
    Found::Finished(Box::new(Rollout {
        report: end.report,
        steps: steps.collect(),
        last,
    }))
}

fn positions(file: &Path) -> Option<Vec<[f32; 3]>> {
    npy::decode(&files::read(file, MAX_BYTES).ok()?)
}

/// Returns whether a rollout took a step in a folder, or ended there.
pub(super) fn has_steps(folder: &Path) -> bool {
    Record::read(folder).is_ok_and(|read| !read.steps.is_empty() || read.end.is_some())
}

/// Returns why the last step of a rollout was not executed, where it was not.
pub(super) fn last_words(folder: &Path) -> Option<String> {
    Record::read(folder).ok()?.steps.pop()?.stopped
}

impl Identity {
    /// Says in what a record's header is of another rollout.
    fn difference(&self, header: &Header) -> Option<String> {
        let policy = |policy: &policy::Description| {
            serde_json::to_string(policy).expect("a description has string keys")
        };
        let pairs = [
            ("program", header.program.clone(), self.program.clone()),
            ("params", header.params.clone(), self.params.clone()),
            ("code", header.code.clone(), self.code.clone()),
            ("start", header.start.digest.clone(), self.start.clone()),
            (
                "policy",
                header.policy.name.clone(),
                self.policy.name.clone(),
            ),
            // The same name, and another model, program or sight behind it.
            ("policy", policy(&header.policy), policy(&self.policy)),
            (
                "horizon",
                header.horizon.to_string(),
                self.horizon.to_string(),
            ),
            (
                "early_stop",
                header.early_stop.to_string(),
                self.early_stop.to_string(),
            ),
            (
                "repetition",
                header.repetition.to_string(),
                self.repetition.to_string(),
            ),
        ];
        let different = pairs.into_iter().find(|(_, there, wanted)| there != wanted);
        different.map(|(what, there, wanted)| {
            format!("its {what} is `{there}`, and `{wanted}` is to be run")
        })
    }
}

impl Rollout {
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
        let last = steps.last().filter(|step| step.line.is_taken());
        if let (Some(goal), Some(last)) = (judged, last)
            && meets(goal, last)
        {
            return Outcome::GoalReached;
        }
        match steps.len() < self.steps.len() {
            true => Outcome::HorizonReached,
            false => self.report.outcome,
        }
    }
}

/// Returns whether a goal that is judged after each step is met; as in a rollout, by the source measure.
fn meets(goal: &Goal, step: &Step) -> bool {
    let value = match goal.metric {
        GoalMetric::Coverage => step.line.measures.coverage,
        GoalMetric::NormalizedImprovement => step.line.measures.normalized_improvement,
        GoalMetric::ParticleDistance => None,
    };
    value.is_some_and(|value| goal.is_met(value))
}

#[cfg(test)]
#[path = "record/tests.rs"]
mod tests;
