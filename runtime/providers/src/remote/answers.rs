//! Answers that were paid for, kept on disk.
//!
//! In: what a question's answer depends on. Out: the answer that is kept, or the right to ask for it. Of several
//! threads with one question, one asks and the others wait for what it keeps. Without a folder nothing is kept, and
//! everybody asks.

use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::calls::Usage;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How soon a waiting thread notices that the user stopped it.
const GLANCE: Duration = Duration::from_millis(50);

/// The form of the kept files; another one is not read.
const FORMAT: u32 = 1;

/// Answers by what they answer; shared by all rollouts.
#[derive(Debug)]
pub struct Answers {
    cache: Cache,
    asked: Mutex<BTreeSet<String>>,
    settled: Condvar,
}

/// An answer as it is kept.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Kept {
    format: u32,
    pub text: String,
    pub usage: Option<Usage>,
}

/// What there is of an answer.
pub(super) enum Found<'a> {
    /// The answer.
    Kept(Kept),
    /// Nothing; this thread asks.
    Nothing(Claim<'a>),
    /// The user stopped the waiting.
    Interrupted,
}

/// The right to ask, until it is dropped.
pub(super) struct Claim<'a> {
    answers: &'a Answers,
    key: String,
}

impl Answers {
    /// Keeps answers in a cache's folder.
    pub fn kept_in(cache: Cache) -> Answers {
        Answers {
            cache,
            asked: Mutex::default(),
            settled: Condvar::new(),
        }
    }

    /// Keeps nothing.
    pub fn none() -> Answers {
        Answers::kept_in(Cache::none())
    }

    /// Returns the answer under `key`, a string of letters and digits; waits while another thread asks for it.
    pub(super) fn find(&self, key: String, interrupt: &Interrupt) -> Found<'_> {
        let mut asked = self.asked();
        loop {
            if interrupt.is_raised() {
                return Found::Interrupted;
            }
            if !self.cache.is_kept() {
                return Found::Nothing(Claim { answers: self, key });
            }
            if !asked.contains(&key) {
                // Under the lock, so that nobody asks between the look and the claim.
                if let Some(kept) = self.read(&key) {
                    return Found::Kept(kept);
                }
                asked.insert(key.clone());
                return Found::Nothing(Claim { answers: self, key });
            }
            let waited = self.settled.wait_timeout(asked, GLANCE);
            asked = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn read(&self, key: &str) -> Option<Kept> {
        let kept: Kept = serde_json::from_slice(&self.cache.get(key)?).ok()?;
        (kept.format == FORMAT).then_some(kept)
    }

    fn asked(&self) -> MutexGuard<'_, BTreeSet<String>> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Claim<'_> {
    /// Keeps the answer.
    pub(super) fn keep(&self, text: &str, usage: Option<Usage>) {
        let kept = Kept {
            format: FORMAT,
            text: text.to_owned(),
            usage,
        };
        let bytes = serde_json::to_vec(&kept).expect("an answer holds a string and numbers");
        // An answer that cannot be kept is still an answer.
        let _ = self.answers.cache.put(&self.key, &bytes);
    }
}

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        self.answers.asked().remove(&self.key);
        self.answers.settled.notify_all();
    }
}
