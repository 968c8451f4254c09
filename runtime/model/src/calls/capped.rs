//! Enforces caps on questions outside any run, without storing anything.

use super::{Budget, Call, CallEnd, CallRefused, Calls, Usd};

/// Enforces the caps of a budget.
#[derive(Debug)]
pub struct Capped<'b> {
    budget: &'b Budget,
    /// The amount reserved for the call in progress.
    at_most: Option<Usd>,
}

impl<'b> Capped<'b> {
    /// Counts calls towards `budget`.
    pub fn by(budget: &'b Budget) -> Capped<'b> {
        Capped {
            budget,
            at_most: None,
        }
    }
}

impl Calls for Capped<'_> {
    fn begin(&mut self, call: &Call<'_>) -> Result<(), CallRefused> {
        self.budget.reserve(call.at_most)?;
        self.at_most = call.at_most;
        Ok(())
    }

    fn end(&mut self, end: &CallEnd<'_>) -> Result<(), CallRefused> {
        self.budget.settle(self.at_most, end);
        Ok(())
    }
}
