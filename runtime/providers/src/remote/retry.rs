//! Decides which failures are retried, how often, and after which wait.
//!
//! In: the faults of one question's calls, as they occur. Out: a wait, or why there is no further attempt. Nothing here
//! waits or sends.

use backon::{BackoffBuilder, ExponentialBackoff, ExponentialBuilder};
use fab_base::wording::counted;
use fab_model::calls::Fault;
use std::collections::BTreeMap;
use std::hash::{BuildHasher, RandomState};
use std::time::Duration;

/// Limits on the calls for one question and the waits between them.
#[derive(Clone, Debug)]
pub struct Retry {
    /// The most calls for one question.
    pub calls: u32,
    /// The first wait, plus a random addition of up to the same length; each later wait is twice as long.
    pub first_wait: Duration,
    /// The longest wait before that addition, unless the provider asks for a longer one.
    pub longest_wait: Duration,
    /// The longest total wait for one question.
    pub waits_in_all: Duration,
}

impl Default for Retry {
    fn default() -> Self {
        Retry {
            calls: 12,
            first_wait: Duration::from_secs(1),
            longest_wait: Duration::from_secs(60),
            waits_in_all: Duration::from_secs(600),
        }
    }
}

/// Returns how many calls for one question may end in this fault; one means no retry.
///
/// A truncated answer is asked for once more only if that call can allow more hidden reasoning.
pub fn most_calls(fault: Fault) -> u32 {
    match fault {
        Fault::RateLimited => 8,
        Fault::ServerFailed | Fault::Unreachable => 5,
        Fault::ConnectionCut => 3,
        Fault::TimedOut | Fault::InvalidReply | Fault::Truncated => 2,
        Fault::QuotaExhausted
        | Fault::NotAuthorised
        | Fault::BadRequest
        | Fault::Refused
        | Fault::ContentFiltered => 1,
    }
}

/// The calls of one question.
pub(super) struct QuestionCalls<'a> {
    retry: &'a Retry,
    made: u32,
    ended: BTreeMap<Fault, u32>,
    waits: ExponentialBackoff,
    waited: Duration,
}

impl<'a> QuestionCalls<'a> {
    pub(super) fn new(retry: &'a Retry) -> QuestionCalls<'a> {
        // With one seed for all, questions that failed together would be retried together.
        let seed = RandomState::new().hash_one(0);
        let waits = ExponentialBuilder::new()
            .with_min_delay(retry.first_wait)
            .with_max_delay(retry.longest_wait)
            .without_max_times()
            .with_jitter()
            .with_jitter_seed(seed);
        QuestionCalls {
            retry,
            made: 0,
            ended: BTreeMap::new(),
            waits: waits.build(),
            waited: Duration::ZERO,
        }
    }

    /// Counts a call and returns its number, from 1.
    pub(super) fn begin(&mut self) -> u32 {
        self.made += 1;
        self.made
    }

    /// Says how many calls were made.
    pub(super) fn in_words(&self) -> String {
        format!("after {}", counted(self.made as usize, "call"))
    }

    /// Returns the wait before another call, or why there is none; `asked` is the wait that the provider asks for.
    pub(super) fn after(
        &mut self,
        fault: Fault,
        asked: Option<Duration>,
    ) -> Result<Duration, String> {
        let ended = self.ended.entry(fault).or_default();
        *ended += 1;
        if *ended >= most_calls(fault) || self.made >= self.retry.calls {
            return Err(self.in_words());
        }
        let wait = self.waits.next().unwrap_or(self.retry.longest_wait);
        let wait = wait.max(asked.unwrap_or_default());
        let waited = self.waited.saturating_add(wait);
        if waited > self.retry.waits_in_all {
            return Err(format!(
                "{}; the next one would have to wait {:.1} s, and {:.1} s in all is the limit",
                self.in_words(),
                wait.as_secs_f64(),
                self.retry.waits_in_all.as_secs_f64()
            ));
        }
        self.waited = waited;
        Ok(wait)
    }
}

#[cfg(test)]
#[path = "tests/retry.rs"]
mod tests;
