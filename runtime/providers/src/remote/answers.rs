//! Paid answers, cached on disk.
//!
//! In: everything that a question's answer depends on. Out: the cached answer, or the right to ask for it. If several
//! threads have the same question, one asks and the others wait for its answer. Without a folder nothing is cached, and
//! everybody asks.

use super::INTERRUPT_POLL;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::calls::Usage;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Cached answers by key; shared by all rollouts.
#[derive(Debug)]
pub struct Answers {
    cache: Cache,
    asked: Mutex<BTreeSet<String>>,
    settled: Condvar,
}

/// A cached answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Cached {
    pub text: String,
    pub usage: Option<Usage>,
}

/// The result of a lookup.
pub(super) enum Lookup<'a> {
    /// The answer.
    Cached(Cached),
    /// No answer; this thread asks.
    Nothing(Claim<'a>),
    /// The user interrupted the wait.
    Interrupted,
}

/// The right to ask, held until it is dropped.
pub(super) struct Claim<'a> {
    answers: &'a Answers,
    key: String,
}

impl Answers {
    /// Caches answers in a cache's folder.
    pub fn kept_in(cache: Cache) -> Answers {
        Answers {
            cache,
            asked: Mutex::default(),
            settled: Condvar::new(),
        }
    }

    /// Caches nothing.
    pub fn none() -> Answers {
        Answers::kept_in(Cache::none())
    }

    /// Returns the answer under `key`, a string of letters and digits; waits while another thread asks for it.
    pub(super) fn find(&self, key: String, interrupt: &Interrupt) -> Lookup<'_> {
        let mut asked = self.asked();
        loop {
            if interrupt.is_raised() {
                return Lookup::Interrupted;
            }
            if !self.cache.is_kept() {
                return Lookup::Nothing(Claim { answers: self, key });
            }
            if !asked.contains(&key) {
                // Under the lock, so nobody can ask between lookup and claim.
                let kept = self.cache.get(&key);
                let kept = kept.and_then(|bytes| serde_json::from_slice(&bytes).ok());
                if let Some(kept) = kept {
                    return Lookup::Cached(kept);
                }
                asked.insert(key.clone());
                return Lookup::Nothing(Claim { answers: self, key });
            }
            let waited = self.settled.wait_timeout(asked, INTERRUPT_POLL);
            asked = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn asked(&self) -> MutexGuard<'_, BTreeSet<String>> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Claim<'_> {
    /// Caches the answer.
    pub(super) fn keep(&self, text: &str, usage: Option<Usage>) {
        let kept = Cached {
            text: text.to_owned(),
            usage,
        };
        let bytes = serde_json::to_vec(&kept).expect("an answer holds a string and numbers");
        // Failing to cache an answer does not make it less of an answer.
        let _ = self.answers.cache.put(&self.key, &bytes);
    }
}

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        self.answers.asked().remove(&self.key);
        self.answers.settled.notify_all();
    }
}
