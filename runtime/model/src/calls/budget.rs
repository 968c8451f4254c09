//! Caps on the calls and cost of a whole run, shared by all of its rollouts.
//!
//! In: calls about to be sent and their results. Out: permission, at once or after a wait. The most that a call may cost
//! is reserved before it is sent, and a call with an unknown cost counts with that full amount. If a reservation does
//! not fit, it waits until calls under way have ended, because most of them cost less than was reserved. So the cap is
//! passed at most by what the calls under way cost beyond their reservations.

use super::{Billing, CallEnd, CallRefused, Usage, Usd};
use fab_base::interrupt::Interrupt;
use fab_base::wording::counted;
use serde::{Deserialize, Serialize};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How often a waiting thread checks whether the user stopped it.
const INTERRUPT_POLL: Duration = Duration::from_millis(50);

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
    /// Answered calls that did not report their usage.
    #[serde(default)]
    pub unreported: u64,
    /// Calls with an unknown cost, or a possible one.
    pub unpriced: u64,
    /// Cost of all answers that reported their usage, billionths of a US dollar.
    #[serde(rename = "cost_nano_usd")]
    pub cost: Usd,
    /// The most that the possibly billed and the unreported calls cost, billionths of a US dollar.
    #[serde(rename = "possibly_nano_usd")]
    pub possibly: Usd,
    /// Tokens of all calls that reported their usage.
    pub usage: Usage,
}

impl Spent {
    /// Adds the result of one call.
    ///
    /// - `at_most`: the amount reserved for it.
    pub fn count(&mut self, at_most: Option<Usd>, end: CallEnd<'_>) {
        self.calls += 1;
        let (cost, usage) = end.map_or_else(|it| (it.cost, it.usage), |it| (it.cost, it.usage));
        self.usage = self.usage + usage.unwrap_or_default();
        self.cost = self.cost + cost.unwrap_or_default();
        let is_free = end.is_err_and(|failed| failed.billing == Billing::No);
        if cost.is_some() || is_free {
            return;
        }
        if end.is_err() {
            self.possibly_billed += 1;
        } else if usage.is_none() {
            self.unreported += 1;
        }
        match at_most {
            Some(at_most) => self.possibly = self.possibly + at_most,
            None => self.unpriced += 1,
        }
    }

    /// Describes the total cost.
    pub fn in_words(&self) -> String {
        let mut text = match self.known_cost() {
            Some(cost) if self.possibly > Usd::ZERO => format!("{cost} to {}", self.at_most()),
            Some(cost) => cost.to_string(),
            None if self.unpriced > 0 => "cost unknown".to_owned(),
            None => format!("at most {}", self.at_most()),
        };
        for (calls, which) in [
            (self.unreported, "without reported usage"),
            (self.possibly_billed, "unanswered and possibly billed"),
        ] {
            if calls > 0 {
                text.push_str(&format!("; {} {which}", counted(calls as usize, "call")));
            }
        }
        text
    }

    /// Describes the tokens; calls that reported none are not in the sums, and hidden ones are named if they are reported.
    pub fn tokens_in_words(&self) -> String {
        let at_least = match self.unreported + self.possibly_billed {
            0 => "",
            _ => "at least ",
        };
        let hidden = self.usage.reasoning_tokens;
        let hidden = hidden.map_or(String::new(), |it| format!(" ({it} of them hidden)"));
        let Usage {
            input_tokens,
            output_tokens,
            ..
        } = self.usage;
        format!("tokens {at_least}{input_tokens} in, {output_tokens} out{hidden}")
    }

    /// Returns the cost of all answers; `None` if a price or the usage of an answer is unknown.
    pub fn known_cost(&self) -> Option<Usd> {
        let is_known = self.unreported == 0 || self.possibly == Usd::ZERO;
        (self.unpriced == 0 && is_known).then_some(self.cost)
    }

    /// Returns the most that everything cost; `None` if a price is unknown.
    pub fn priced_at_most(&self) -> Option<Usd> {
        (self.unpriced == 0).then(|| self.at_most())
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
    interrupt: Interrupt,
    state: Mutex<State>,
    ended: Condvar,
}

#[derive(Debug, Default)]
struct State {
    spent: Spent,
    /// What is reserved for each call in progress; `None` if its price is unknown.
    under_way: Vec<Option<Usd>>,
}

impl State {
    /// Reserves what a call may cost; `false`: it fits only if calls under way cost less than is reserved for them.
    ///
    /// Fails with the cap that lets no further call through.
    fn admit(&mut self, caps: Caps, at_most: Option<Usd>) -> Result<bool, String> {
        let under_way = self.under_way.len() as u64;
        // Each call under way will count, whatever its end, so waiting would not help.
        if let Some(cap) = caps.calls
            && self.spent.calls + under_way >= cap
        {
            let calls = counted(cap as usize, "call");
            return Err(format!(
                "the cap of {calls} is reached; a higher `--max-calls` allows more"
            ));
        }
        if let Some(cap) = caps.cost {
            let at_most = at_most.ok_or_else(|| {
                format!(
                    "the cost cap of {cap} cannot be enforced, because the price of this model is unknown; use \
                     `--max-calls` instead"
                )
            })?;
            let taken = self.spent.at_most();
            let reserved: Usd = self.under_way.iter().copied().flatten().sum();
            if taken + reserved + at_most > cap {
                if under_way > 0 {
                    return Ok(false);
                }
                return Err(format!(
                    "the next call may cost {at_most}, and {taken} of the cap of {cap} are used; a higher `--max-cost` \
                     allows more"
                ));
            }
        }
        self.under_way.push(at_most);
        Ok(true)
    }

    /// Gives back what was reserved for a call, and counts the call if it was sent.
    fn end(&mut self, at_most: Option<Usd>, end: Option<CallEnd<'_>>) {
        if let Some(index) = self.under_way.iter().position(|its| *its == at_most) {
            self.under_way.swap_remove(index);
        }
        if let Some(end) = end {
            self.spent.count(at_most, end);
        }
    }
}

impl Budget {
    /// Makes a budget of which nothing is used; waits end when `interrupt` is raised.
    pub fn new(caps: Caps, interrupt: &Interrupt) -> Budget {
        Budget {
            caps,
            interrupt: interrupt.clone(),
            ..Budget::default()
        }
    }

    /// Returns what has been spent so far, without calls in progress.
    pub fn spent(&self) -> Spent {
        self.state().spent
    }

    /// Counts what earlier parts of the same run spent.
    pub fn restore(&self, spent: &Spent) {
        let all = &mut self.state().spent;
        all.calls += spent.calls;
        all.possibly_billed += spent.possibly_billed;
        all.unreported += spent.unreported;
        all.unpriced += spent.unpriced;
        all.cost = all.cost + spent.cost;
        all.possibly = all.possibly + spent.possibly;
        all.usage = all.usage + spent.usage;
    }

    /// Reserves what a call may cost; waits for calls under way if that exceeds a cap, and fails if none is.
    ///
    /// - `at_most`: `None` if the price is unknown.
    pub(super) fn reserve(&self, at_most: Option<Usd>) -> Result<(), CallRefused> {
        let mut state = self.state();
        loop {
            if self.interrupt.is_raised() {
                return Err(CallRefused::Interrupted);
            }
            if state
                .admit(self.caps, at_most)
                .map_err(CallRefused::Budget)?
            {
                return Ok(());
            }
            let waited = self.ended.wait_timeout(state, INTERRUPT_POLL);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Gives back what was reserved for a call, and counts the call; `None`: it was not sent.
    pub(super) fn end(&self, at_most: Option<Usd>, end: Option<CallEnd<'_>>) {
        self.state().end(at_most, end);
        self.ended.notify_all();
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // A panic cannot interrupt a change halfway, so a poisoned lock still guards sound data.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
#[path = "budget/tests.rs"]
mod tests;
