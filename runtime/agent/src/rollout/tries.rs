//! Counts actions and steps: a step whose result does not match its subgoal may take further actions.

use crate::result::StepResult;

/// Assigns actions to steps.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tries {
    /// Actions begun.
    pub number: u32,
    /// Steps that are finished.
    pub done: u32,
    /// Retries begun for the current step.
    retries: u32,
    /// The result of the last action, if the step must be retried.
    pub before: Option<StepResult>,
}

impl Tries {
    /// Returns the current step, from 1; `None` if the rollout is over.
    pub fn step(&self, horizon: u32) -> Option<u32> {
        (self.done < horizon).then_some(self.done + 1)
    }

    /// Decides whether the current step is over: its result matches the subgoal, or it was retried often enough.
    ///
    /// - `most`: the most actions of a step, at least 1.
    pub fn after(&mut self, most: u32, result: Option<StepResult>) {
        let again = self.retries + 1 < most;
        self.before = result.filter(|result| !result.is_enough && again);
        if self.before.is_some() {
            self.retries += 1;
        } else {
            self.done += 1;
            self.retries = 0;
        }
    }
}
