//! Caps on questions outside of any run: held, and nothing is kept.

use super::{Budget, Call, CallEnd, CallRefused, Calls, Usd};

/// Holds the caps of a budget.
#[derive(Debug)]
pub struct Capped<'b> {
    budget: &'b Budget,
    /// What was set aside for the call under way.
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
