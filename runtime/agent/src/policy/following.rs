//! The policy that repeats decisions found elsewhere.
//!
//! In: a choice for each action of a rollout. Out: the same actions, through the same checks as any other policy's. It
//! shows that the result of a search is one that answers could have given.

use super::proposing::{Answer, Proposed, until_accepted};
use super::{Decision, Description, Exchange, Kind, Policy, PolicyError, StepView};
use crate::best::Choice;
use crate::outcome::Outcome;

/// Repeats decisions.
#[derive(Clone, Debug)]
pub struct Following {
    /// What the decisions are, for the run record.
    pub name: String,
    /// One for each action, in order.
    pub choices: Vec<Choice>,
}

impl Policy for Following {
    fn description(&self) -> Description {
        Description {
            kind: Kind::Following,
            name: self.name.clone(),
            // Whoever found the decisions looked at particles.
            sees_particles: true,
            models: None,
            code: None,
        }
    }

    fn varies(&self) -> bool {
        false
    }

    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, PolicyError> {
        let choice = self.choices.get(step.number as usize - 1);
        if let Some(Choice::Skip) = choice {
            return Ok(Decision::Skip(Outcome::MalformedReply));
        }
        until_accepted(step, exchange, &mut |_, _| {
            let answer = match choice {
                Some(Choice::Act { proposal, .. }) => Answer::Grip(proposal.clone()),
                Some(Choice::Skip) | None => Answer::Stop {
                    outcome: Outcome::PolicyStopped,
                    why: format!("only {} decisions are known", self.choices.len()),
                },
            };
            Ok(Proposed {
                question: None,
                reply: None,
                note: None,
                answer,
            })
        })
    }
}
