//! Caps on the calls and cost of a whole run, shared by all of its rollouts.
//!
//! In: calls about to be sent and their results. Out: permission. A cap is hard: the most that a call may cost is
//! reserved before it is sent, and a call that may have been billed counts with that full amount.

use super::{Billing, CallEnd, CallRefused, Usage, Usd};
use serde::{Deserialize, Serialize};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The most that a run may use; `None` means no cap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Caps {
    /// The most money.
    pub cost: Option<Usd>,
    /// The most calls.
    pub calls: Option<u64>,
}

/// What calls added up to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spent {
    /// Calls that were sent, or were about to be when the process ended.
    pub calls: u64,
    /// Calls without an answer that may have been billed.
    pub possibly_billed: u64,
    /// Calls with an unknown cost, or a possible one.
    pub unpriced: u64,
    /// Cost of all answers, billionths of a US dollar.
    pub cost: Usd,
    /// The most that the possibly billed calls cost, billionths of a US dollar.
    pub possibly: Usd,
    /// Tokens of all answers.
    pub usage: Usage,
}

impl Spent {
    /// Adds the result of one call.
    ///
    /// - `at_most`: the amount reserved for it.
    pub fn count(&mut self, at_most: Option<Usd>, end: &CallEnd<'_>) {
        self.calls += 1;
        match end {
            CallEnd::Answered(reply) => {
                self.usage = self.usage + reply.usage.unwrap_or_default();
                match reply.cost.or(at_most) {
                    Some(cost) => self.cost = self.cost + cost,
                    None => self.unpriced += 1,
                }
            }
            CallEnd::Failed { billing, cost, .. } => match (billing, cost) {
                (_, Some(cost)) => self.cost = self.cost + *cost,
                (Billing::Possibly, None) => {
                    self.possibly_billed += 1;
                    match at_most {
                        Some(at_most) => self.possibly = self.possibly + at_most,
                        None => self.unpriced += 1,
                    }
                }
                (Billing::No, None) => {}
            },
        }
    }

    /// Adds another count to this one.
    pub fn absorb(&mut self, other: &Spent) {
        self.calls += other.calls;
        self.possibly_billed += other.possibly_billed;
        self.unpriced += other.unpriced;
        self.cost = self.cost + other.cost;
        self.possibly = self.possibly + other.possibly;
        self.usage = self.usage + other.usage;
    }

    /// Describes the total cost.
    pub fn in_words(&self) -> String {
        match (self.unpriced, self.possibly_billed) {
            (0, 0) => self.cost.to_string(),
            (0, unanswered) => format!(
                "{}; {unanswered} unanswered calls may also have been billed, up to {}",
                self.cost, self.possibly
            ),
            (_, 0) => "cost not known".to_owned(),
            (_, unanswered) => {
                format!("cost unknown; {unanswered} unanswered calls may have been billed")
            }
        }
    }

    /// Returns the most that everything cost, as far as prices are known.
    pub fn at_most(&self) -> Usd {
        self.cost + self.possibly
    }
}

/// Caps, and what counts towards them so far.
#[derive(Debug, Default)]
pub struct Budget {
    caps: Caps,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    spent: Spent,
    /// Reserved for calls in progress.
    reserved: Usd,
    /// Number of calls in progress.
    under_way: u64,
}

impl Budget {
    /// Makes a budget with `spent` already used by earlier parts of the same run.
    pub fn new(caps: Caps, spent: Spent) -> Budget {
        Budget {
            caps,
            state: Mutex::new(State {
                spent,
                ..State::default()
            }),
        }
    }

    /// Returns what has been spent so far, without calls in progress.
    pub fn spent(&self) -> Spent {
        self.state().spent
    }

    /// Counts what earlier parts of the same run spent.
    pub fn restore(&self, spent: &Spent) {
        self.state().spent.absorb(spent);
    }

    /// Reserves what a call may cost; fails if that would exceed a cap.
    pub(super) fn reserve(&self, at_most: Option<Usd>) -> Result<(), CallRefused> {
        let mut state = self.state();
        let calls = state.spent.calls + state.under_way;
        if let Some(cap) = self.caps.calls.filter(|cap| calls >= *cap) {
            let noun = if cap == 1 { "call" } else { "calls" };
            return Err(CallRefused::Budget(format!(
                "the cap of {cap} {noun} is reached; a higher `--max-calls` continues from here"
            )));
        }
        if let Some(cap) = self.caps.cost {
            let Some(at_most) = at_most else {
                return Err(CallRefused::Budget(format!(
                    "the cost cap of {cap} cannot be enforced, because the price of this model is unknown; use \
                     `--max-calls` instead"
                )));
            };
            let taken = state.spent.at_most() + state.reserved;
            if taken > cap {
                return Err(CallRefused::Budget(format!(
                    "the cap of {cap} is passed by {}: a call cost more than was to be expected",
                    taken.less(cap)
                )));
            }
            if taken + at_most > cap {
                return Err(CallRefused::Budget(format!(
                    "the next call may cost {at_most}, and of the cap of {cap} {} is left; a higher `--max-cost` \
                     continues from here",
                    cap.less(taken)
                )));
            }
        }
        state.under_way += 1;
        state.reserved = state.reserved + at_most.unwrap_or_default();
        Ok(())
    }

    /// Counts a call for which `at_most` was reserved.
    pub(super) fn settle(&self, at_most: Option<Usd>, end: &CallEnd<'_>) {
        let mut state = self.state();
        state.under_way = state.under_way.saturating_sub(1);
        state.reserved = state.reserved.less(at_most.unwrap_or_default());
        state.spent.count(at_most, end);
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // A panic cannot interrupt a change halfway, so a poisoned lock still guards sound data.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Reply;
    use crate::calls::Fault;

    fn usd(dollars: f64) -> Option<Usd> {
        Some(Usd::from_dollars(dollars).unwrap())
    }

    fn reply(cost: Option<Usd>) -> Reply {
        Reply {
            cost,
            ..Reply::text("yes")
        }
    }

    fn failed(billing: Billing) -> CallEnd<'static> {
        CallEnd::Failed {
            fault: Fault::TimedOut,
            why: "",
            billing,
            cost: None,
        }
    }

    #[test]
    fn money_is_set_aside_before_a_call_and_the_rest_given_back_after_it() {
        let caps = Caps {
            cost: usd(1.0),
            calls: None,
        };
        let budget = Budget::new(caps, Spent::default());
        budget.reserve(usd(0.6)).unwrap();
        let refused = budget.reserve(usd(0.6)).unwrap_err().to_string();
        assert!(refused.contains("0.4000 USD is left"), "{refused}");
        budget.settle(usd(0.6), &CallEnd::Answered(&reply(usd(0.1))));
        budget.reserve(usd(0.9)).unwrap();
        budget.settle(usd(0.9), &failed(Billing::Possibly));
        assert!(budget.reserve(usd(0.01)).is_err());
        let spent = budget.spent();
        assert_eq!((spent.calls, spent.possibly_billed), (2, 1));
        assert_eq!(Some(spent.cost), usd(0.1));
        assert_eq!(Some(spent.at_most()), usd(1.0));
    }

    #[test]
    fn calls_under_way_count_towards_the_cap() {
        let caps = Caps {
            cost: None,
            calls: Some(2),
        };
        let earlier = Spent {
            calls: 1,
            ..Spent::default()
        };
        let budget = Budget::new(caps, earlier);
        budget.reserve(None).unwrap();
        assert!(budget.reserve(None).is_err());
        budget.settle(None, &failed(Billing::No));
        assert!(budget.reserve(None).is_err());
        assert_eq!(budget.spent().possibly_billed, 0);
    }

    #[test]
    fn a_cap_on_an_unknown_cost_lets_nothing_through() {
        let caps = Caps {
            cost: usd(5.0),
            calls: None,
        };
        let refused = Budget::new(caps, Spent::default()).reserve(None);
        assert!(refused.unwrap_err().to_string().contains("is unknown"));
        let free = Budget::new(Caps::default(), Spent::default());
        free.reserve(None).unwrap();
        free.settle(None, &CallEnd::Answered(&reply(None)));
        assert_eq!(free.spent().unpriced, 1);
    }
}
