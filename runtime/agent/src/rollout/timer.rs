//! Measures wall time by activity.

use serde_json::{Map, Value, json};
use std::time::{Duration, Instant};

/// Sums wall time by activity, in the order of first use.
#[derive(Clone, Debug, Default)]
pub(super) struct Timer {
    /// Seconds by activity.
    pub seconds: Map<String, Value>,
    /// The part that is planning: all but the model, the motion and the writing of files.
    pub planning: Duration,
}

impl Timer {
    pub(super) fn add(&mut self, what: &str, took: Duration) {
        let sum_s = self.seconds.get(what).and_then(Value::as_f64);
        let sum_s = sum_s.unwrap_or(0.0) + took.as_secs_f64();
        self.seconds.insert(what.to_owned(), json!(sum_s));
    }

    /// Adds another timer's sums.
    pub(super) fn absorb(&mut self, other: &Timer) {
        for (what, took_s) in &other.seconds {
            let took_s = took_s.as_f64().unwrap_or(0.0);
            self.add(what, Duration::from_secs_f64(took_s));
        }
    }

    /// Adds a piece of planning.
    pub(super) fn add_planning(&mut self, what: &str, took: Duration) {
        self.add(what, took);
        self.planning += took;
    }

    /// Times a piece of planning.
    pub(super) fn plan<T>(&mut self, what: &str, work: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let result = work();
        self.add_planning(what, begun.elapsed());
        result
    }
}
