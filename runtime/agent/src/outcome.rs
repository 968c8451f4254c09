//! How a rollout can end: a closed list that scripts rely on.

use serde::{Deserialize, Serialize};

/// The end of a rollout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The declared goal was met.
    GoalReached,
    /// Every step was done; the goal, if declared, was not met.
    HorizonReached,
    /// A check refused the last permitted answer of a step.
    AttemptsExhausted,
    /// The last permitted answer of a step could not be read.
    MalformedReply,
    /// The detectors found no point to offer.
    NoCandidates,
    /// No pixel of the picture shows cloth.
    ClothOutOfView,
    /// The model gave no answer.
    ModelFailed,
    /// The policy failed: its program hung, exited, or gave an invalid answer.
    PolicyFailed,
    /// The policy proposed nothing further, and said why.
    PolicyStopped,
    /// The twins of a rehearsal cannot be trusted, and the task says that nothing real moves without them.
    RehearsalRefused,
    /// A cap on calls or cost stopped the rollout.
    BudgetExhausted,
    /// The world could not be observed or moved.
    WorldFailed,
    /// The user stopped the rollout, or did not permit a motion.
    Interrupted,
    /// The first action was planned, as asked, and nothing moved.
    Planned,
}

impl Outcome {
    /// Returns the name that JSON and journals use.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::GoalReached => "goal_reached",
            Outcome::HorizonReached => "horizon_reached",
            Outcome::AttemptsExhausted => "attempts_exhausted",
            Outcome::MalformedReply => "malformed_reply",
            Outcome::NoCandidates => "no_candidates",
            Outcome::ClothOutOfView => "cloth_out_of_view",
            Outcome::ModelFailed => "model_failed",
            Outcome::PolicyFailed => "policy_failed",
            Outcome::PolicyStopped => "policy_stopped",
            Outcome::RehearsalRefused => "rehearsal_refused",
            Outcome::BudgetExhausted => "budget_exhausted",
            Outcome::WorldFailed => "world_failed",
            Outcome::Interrupted => "interrupted",
            Outcome::Planned => "planned",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_equal_the_serialised_form() {
        for outcome in [
            Outcome::GoalReached,
            Outcome::HorizonReached,
            Outcome::AttemptsExhausted,
            Outcome::MalformedReply,
            Outcome::NoCandidates,
            Outcome::ClothOutOfView,
            Outcome::ModelFailed,
            Outcome::PolicyFailed,
            Outcome::PolicyStopped,
            Outcome::RehearsalRefused,
            Outcome::BudgetExhausted,
            Outcome::WorldFailed,
            Outcome::Interrupted,
            Outcome::Planned,
        ] {
            assert_eq!(
                serde_json::json!(outcome),
                serde_json::json!(outcome.name())
            );
        }
    }
}
