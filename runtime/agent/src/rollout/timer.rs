//! Measures wall time by activity.

use serde_json::{Map, Value, json};
use std::time::Duration;

/// Sums wall time by activity, in the order of first use.
#[derive(Clone, Debug, Default)]
pub(super) struct Timer {
    spent: Vec<(String, Duration)>,
}

impl Timer {
    pub(super) fn add(&mut self, what: &str, took: Duration) {
        match self.spent.iter_mut().find(|(known, _)| known == what) {
            Some((_, spent)) => *spent += took,
            None => self.spent.push((what.to_owned(), took)),
        }
    }

    /// Adds another timer's sums.
    pub(super) fn absorb(&mut self, other: &Timer) {
        for (what, spent) in &other.spent {
            self.add(what, *spent);
        }
    }

    pub(super) fn time<T>(&mut self, what: &str, work: impl FnOnce() -> T) -> T {
        let begun = std::time::Instant::now();
        let result = work();
        self.add(what, begun.elapsed());
        result
    }

    pub(super) fn write(&self, into: &mut Map<String, Value>) {
        for (what, spent) in &self.spent {
            into.insert(what.clone(), json!(spent.as_secs_f64()));
        }
    }
}
