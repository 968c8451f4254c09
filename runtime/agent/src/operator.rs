//! The operator's judgement of a finished rollout.
//!
//! In: the rollout's report. Out: a [`Judgement`], which is stored in the journal's last line. On a real table the
//! positions of the cloth's particles are unknown, so a person judges a fold, as in the paper. The caller decides who
//! is asked, and how; nothing here prints.

use crate::judgement::Judgement;
use crate::outcome::Outcome;
use crate::record::Report;
use std::path::Path;

/// Somebody who judges the result of a rollout.
pub trait Operator: Sync {
    /// Returns the operator's judgement of a rollout with the run folder `folder`; `None` if nobody answers, which is
    /// recorded as such.
    ///
    /// Asked once, when the rest of the report is known, and never again when the run folder is read.
    fn judge(&self, report: &Report, folder: &Path) -> Option<Judgement>;
}

/// Returns whether there is something to judge: not if the rollout was interrupted, ran out of budget, lost its model,
/// or was only planned.
pub(crate) fn is_judged(outcome: Outcome) -> bool {
    !matches!(
        outcome,
        Outcome::Interrupted | Outcome::BudgetExhausted | Outcome::ModelFailed | Outcome::Planned
    )
}
