//! Reads the folder of a finished rollout.
//!
//! In: a run folder. Out: a [`Rollout`], or that none has ended there. Tables are made from run folders alone, so a
//! rollout gives the same figures whether it ran just now or was found finished.

use fab_agent::outcome::Outcome;
use fab_agent::policy;
use fab_agent::record::{self, Header, MAX_BYTES, Record, RecordError, Report, StepSpent};
use fab_base::{difference, files, npy};
use fab_model::calls::Usd;
use fab_program::Goal;
use fab_world::vary::AxisValues;
use serde::Serialize;
use serde_json::json;
use std::path::Path;

/// A rollout that has ended by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Rollout {
    /// Its results.
    pub report: Report,
    /// Its steps, in order; the last one may have ended it.
    pub steps: Vec<Step>,
    /// Final positions, grid order, world frame, metres; `None` if nothing was ever executed.
    pub last: Option<Vec<[f32; 3]>>,
}

/// One step of a rollout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// The questions, the action and the measures.
    pub line: record::Step,
    /// Durations and costs.
    pub spent: StepSpent,
    /// Cost of its answers, US dollars; `None` if a price or a usage is unknown.
    pub cost_usd: Option<f64>,
    /// The most that its calls cost, US dollars; `None` if a price is unknown.
    pub cost_usd_at_most: Option<f64>,
}

/// The identity of a rollout; rollouts with the same identity have the same figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Identity {
    /// Hash of the program.
    pub program: String,
    /// The values in which the world differs from the task's own.
    pub vary: AxisValues,
    /// Hash of the world's parameters.
    pub params: String,
    /// Digest of the world's code.
    pub code: String,
    /// Digest of the start.
    pub start: String,
    /// The policy.
    pub policy: policy::Description,
    /// The most actions.
    pub horizon: u32,
    /// Whether a goal judged after each step ends it.
    pub early_stop: bool,
    /// The number of the rollout among those of the same start.
    pub repetition: u32,
    /// The start that its answers were drawn for; `None` if equal questions at all starts share them.
    pub drawn_for: Option<u64>,
}

/// The contents of a folder.
#[derive(Clone, Debug, PartialEq)]
pub enum FolderContents {
    /// Nothing, or a rollout that was interrupted or stopped by a cap.
    Unfinished,
    /// Another rollout; the text says what differs.
    Other(String),
    /// The rollout.
    Finished(Box<Rollout>),
}

/// Reads a run folder.
pub fn find(folder: &Path, wanted: &Identity) -> FolderContents {
    let read = match Record::read(folder) {
        Ok(read) => read,
        Err(RecordError::Absent(_)) => return FolderContents::Unfinished,
        // A retry would read the same record again.
        Err(error) => return FolderContents::Other(error.to_string()),
    };
    if let Some(difference) = wanted.difference(&read.header) {
        return FolderContents::Other(difference);
    }
    let Some(end) = read.end else {
        return FolderContents::Unfinished;
    };
    let positions = |file: &String| {
        let bytes = files::read(&folder.join(file), MAX_BYTES).ok();
        bytes.and_then(|bytes| npy::decode(&bytes))
    };
    let last = end.final_positions.as_ref().map(positions);
    let is_stopped = [Outcome::Interrupted, Outcome::BudgetExhausted].contains(&end.report.outcome);
    if is_stopped || last == Some(None) {
        return FolderContents::Unfinished;
    }
    let mut spent = read.spent;
    let (mut cost_usd, mut cost_usd_at_most) = (0.0, 0.0);
    let steps = read.steps.into_iter().map(|line| {
        let spent = spent.remove(&line.step).unwrap_or_default();
        // A step's cost is its cumulative cost minus the previous one.
        let own = |so_far: Option<Usd>, before: &mut f64| {
            let so_far = so_far.map(Usd::dollars);
            so_far.map(|so_far| so_far - std::mem::replace(before, so_far))
        };
        Step {
            line,
            cost_usd: own(spent.so_far.known_cost(), &mut cost_usd),
            cost_usd_at_most: own(spent.so_far.priced_at_most(), &mut cost_usd_at_most),
            spent,
        }
    });
    FolderContents::Finished(Box::new(Rollout {
        report: end.report,
        steps: steps.collect(),
        last: last.flatten(),
    }))
}

/// Returns whether a rollout took a step in a folder, or ended there.
pub(super) fn has_steps(folder: &Path) -> bool {
    Record::read(folder).is_ok_and(|read| !read.steps.is_empty() || read.end.is_some())
}

/// Returns why the last step of a rollout was not executed, if it was not.
pub(super) fn last_words(folder: &Path) -> Option<String> {
    Record::read(folder).ok()?.steps.pop()?.stopped
}

impl Identity {
    /// Says how a record's header differs from this identity.
    fn difference(&self, header: &Header) -> Option<String> {
        let recorded = Identity {
            program: header.program.clone(),
            vary: header.vary.clone(),
            params: header.params.clone(),
            code: header.code.clone(),
            start: header.start.digest.clone(),
            policy: header.policy.clone(),
            horizon: header.horizon,
            early_stop: header.early_stop,
            repetition: header.repetition,
            drawn_for: header.drawn_for,
        };
        let document = |identity| json!(identity);
        let found = difference::first(&document(&recorded), &document(self))?;
        let advice = if self.drawn_for != header.drawn_for {
            "; `--share-answers` decides whether each start draws answers of its own"
        } else {
            ""
        };
        Some(format!(
            "it is not what the suite asks for: it differs in {found}{advice}"
        ))
    }
}

impl Rollout {
    /// Returns the steps that count within `horizon` actions.
    ///
    /// With `stop`, only those up to and including the first that meets the goal, if it is judged after each step.
    pub fn steps_to(&self, horizon: u32, stop: Option<&Goal>) -> &[Step] {
        let within = &self.steps[..self.steps.len().min(horizon as usize)];
        match stop.and_then(|goal| within.iter().position(|step| step.line.measures.meet(goal))) {
            Some(at) => &within[..=at],
            None => within,
        }
    }

    /// Returns how the rollout would have ended with `horizon` actions.
    pub fn outcome_at(&self, horizon: u32, goal: Option<&Goal>, stop: Option<&Goal>) -> Outcome {
        let judged = goal.filter(|goal| goal.metric.is_judged_each_step());
        let steps = self.steps_to(horizon, stop);
        let last = steps.last().filter(|step| step.line.is_taken());
        if let (Some(goal), Some(last)) = (judged, last)
            && last.line.measures.meet(goal)
        {
            return Outcome::GoalReached;
        }
        if steps.len() < self.steps.len() {
            Outcome::HorizonReached
        } else {
            self.report.outcome
        }
    }
}

#[cfg(test)]
#[path = "record/tests.rs"]
mod tests;
