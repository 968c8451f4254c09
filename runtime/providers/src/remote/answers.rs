//! Paid answers, cached on disk.
//!
//! In: everything that a question's answer depends on. Out: the cached answer, and a lock for the one who asks. If several
//! threads have the same question, one asks and the others wait for its answer. Without a folder nothing is cached, and
//! everybody asks.

use super::wire::Answer;
use fab_base::cache::Cache;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Held by the one who asks a question.
pub(super) type Asking = tokio::sync::Mutex<()>;

/// Cached answers by key; shared by all rollouts.
#[derive(Debug)]
pub struct Answers {
    cache: Cache,
    asked: Mutex<BTreeMap<String, Arc<Asking>>>,
}

impl Answers {
    /// Caches answers in a cache's folder.
    pub fn kept_in(cache: Cache) -> Answers {
        Answers {
            cache,
            asked: Mutex::default(),
        }
    }

    /// Caches nothing.
    pub fn none() -> Answers {
        Answers::kept_in(Cache::none())
    }

    /// Returns the lock of a question.
    pub(super) fn lock(&self, key: &str) -> Arc<Asking> {
        if !self.cache.is_kept() {
            return Arc::default();
        }
        let mut asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(asked.entry(key.to_owned()).or_default())
    }

    /// Returns the answer under a key of letters and digits; under its lock, so that nobody asks in between.
    pub(super) fn get(&self, key: &str) -> Option<Answer> {
        serde_json::from_slice(&self.cache.get(key)?).ok()
    }

    /// Caches an answer.
    pub(super) fn put(&self, key: &str, answer: &Answer) {
        let bytes = serde_json::to_vec(answer).expect("an answer holds a string and numbers");
        // Failing to cache an answer does not make it less of an answer.
        let _ = self.cache.put(key, &bytes);
    }
}
