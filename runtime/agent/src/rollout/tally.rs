//! Counts a rollout's questions, refusals and skipped steps, and its planning time.

use crate::outcome::Outcome;
use crate::policy::{Attempt, Finding};
use fab_program::verify::Verdict;
use std::collections::BTreeMap;

/// Counts of a whole rollout.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    /// Requests sent.
    pub queries: u32,
    /// Refused actions by check.
    pub refusals: BTreeMap<String, u32>,
    /// Answers that could not be read.
    pub malformed: u32,
    /// Skipped steps by the outcome that they would have been.
    pub skipped: BTreeMap<String, u32>,
    /// Retries of steps whose result did not match the subgoal.
    pub retries: u32,
    planned: u32,
    planning_s: f64,
}

impl Tally {
    pub(super) fn attempt(&mut self, attempt: &Attempt) {
        self.queries += u32::from(attempt.question.is_some());
        match &attempt.finding {
            Finding::Action {
                verdict: Verdict::Reject { check, .. },
                ..
            } => *self.refusals.entry(check.clone()).or_default() += 1,
            Finding::Malformed { .. } => self.malformed += 1,
            Finding::Action { .. } | Finding::Text { .. } | Finding::Failed { .. } => {}
        }
    }

    pub(super) fn skip(&mut self, why: Outcome) {
        *self.skipped.entry(why.name().to_owned()).or_default() += 1;
    }

    /// Adds the planning time of one action, seconds.
    pub(super) fn planned(&mut self, took_s: f64) {
        self.planned += 1;
        self.planning_s += took_s;
    }

    /// Returns the mean planning time of an action, seconds; `None` if none was planned.
    pub(super) fn planning_s(&self) -> Option<f64> {
        (self.planned > 0).then(|| self.planning_s / f64::from(self.planned))
    }

    pub(super) fn skipped_steps(&self) -> u32 {
        self.skipped.values().sum()
    }
}
