//! How a rollout can end: a closed list that scripts rely on.

use serde::{Deserialize, Serialize};

fab_base::named! {
    /// The end of a rollout.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Outcome {
        /// The declared goal was met.
        GoalReached = "goal_reached",
        /// Every step was done; the goal, if declared, was not met.
        #[default]
        HorizonReached = "horizon_reached",
        /// A check refused the last permitted answer of a step.
        AttemptsExhausted = "attempts_exhausted",
        /// The last permitted answer of a step could not be read.
        MalformedReply = "malformed_reply",
        /// The detectors found no point to offer.
        NoCandidates = "no_candidates",
        /// No pixel of the picture shows cloth.
        ClothOutOfView = "cloth_out_of_view",
        /// The model gave no answer.
        ModelFailed = "model_failed",
        /// The policy failed: its program hung, exited, or gave an invalid answer.
        PolicyFailed = "policy_failed",
        /// The policy proposed nothing further, and said why.
        PolicyStopped = "policy_stopped",
        /// The twins of a rehearsal cannot be trusted, and the task says that nothing real moves without them.
        RehearsalRefused = "rehearsal_refused",
        /// A cap on calls or cost stopped the rollout.
        BudgetExhausted = "budget_exhausted",
        /// The world could not be observed or moved.
        WorldFailed = "world_failed",
        /// The user stopped the rollout, or did not permit a motion.
        Interrupted = "interrupted",
        /// The first action was planned, as asked, and nothing moved.
        Planned = "planned",
    }
}

impl Outcome {
    /// Returns whether a rollout that ended so went through the task, so that its end is scored.
    pub fn is_scored(self) -> bool {
        matches!(
            self,
            Outcome::HorizonReached | Outcome::GoalReached | Outcome::PolicyStopped
        )
    }

    /// Returns whether there is something for an operator to judge: not if the rollout was interrupted, ran out of budget,
    /// lost its model, or was only planned.
    pub(crate) fn is_judged(self) -> bool {
        !matches!(
            self,
            Outcome::Interrupted
                | Outcome::BudgetExhausted
                | Outcome::ModelFailed
                | Outcome::Planned
        )
    }
}
