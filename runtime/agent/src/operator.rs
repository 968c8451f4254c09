//! What the person beside an arm says of a rollout that has ended.
//!
//! In: the rollout's report. Out: a [`Judgement`], which the journal keeps in its last line. On a real table nobody knows where the
//! cloth's particles are, so a fold is judged by a person, as in the paper. Who asks, and how, is the caller's business;
//! nothing here prints.

use crate::judgement::Judgement;
use crate::outcome::Outcome;
use crate::record::Report;
use std::path::Path;

/// Somebody who says what came of a rollout.
pub trait Operator: Sync {
    /// Returns what the operator says of a rollout, whose run folder is `folder`; none where nobody answers, which is kept as such.
    ///
    /// Asked once, when everything else of the report is known, and never again when the run folder is read.
    fn judge(&self, report: &Report, folder: &Path) -> Option<Judgement>;
}

/// Returns whether there is something to judge: not where the rollout was broken off for want of a model or of time, or only planned.
pub(crate) fn is_judged(outcome: Outcome) -> bool {
    !matches!(
        outcome,
        Outcome::Interrupted | Outcome::BudgetExhausted | Outcome::ModelFailed | Outcome::Planned
    )
}
