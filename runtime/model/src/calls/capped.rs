//! Enforces caps on questions outside any run, without storing anything.

use super::budget::Reservation;
use super::{Budget, Call, CallEnd, CallRefused, Calls};

/// Enforces the caps of a budget.
#[derive(Debug)]
pub struct Capped<'b> {
    budget: &'b Budget,
    /// The call in progress.
    open: Option<Reservation<'b>>,
    last_failure: Option<String>,
}

impl<'b> Capped<'b> {
    /// Counts calls towards `budget`.
    pub fn by(budget: &'b Budget) -> Capped<'b> {
        Capped {
            budget,
            open: None,
            last_failure: None,
        }
    }

    /// Returns why the last call gave no answer; `None` if it gave one.
    pub fn last_failure(&self) -> Option<&str> {
        self.last_failure.as_deref()
    }
}

impl Calls for Capped<'_> {
    fn begin(&mut self, call: &Call<'_>) -> Result<(), CallRefused> {
        self.open = Some(self.budget.reserve(call.at_most)?);
        Ok(())
    }

    fn end(&mut self, end: &CallEnd<'_>) -> Result<(), CallRefused> {
        if let Some(open) = self.open.take() {
            open.settle(end);
        }
        self.last_failure = match end {
            CallEnd::Answered(_) => None,
            CallEnd::Failed(failed) => Some(failed.why.clone()),
        };
        Ok(())
    }
}
