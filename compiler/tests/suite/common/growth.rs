//! Whether work grows no faster than its text, by the time that the thread computes, whatever runs beside it.

use std::fs;
use std::time::{Duration, Instant};

/// Time that this thread has computed; where the system does not say, time that has passed.
fn computed(begun: Instant) -> Duration {
    let spent = fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = spent.and_then(|it| it.split_whitespace().next()?.parse().ok());
    nanoseconds.map_or_else(|| begun.elapsed(), Duration::from_nanos)
}

/// Does work on eight pieces of a length, and on one of eight times that, which may take three times as long.
///
/// Equal amounts of text, so that what a clock cannot tell apart counts little. Quadratic work takes eight times as long.
pub fn assert_linear(what: &str, length: usize, work: impl Fn(usize)) {
    let begun = Instant::now();
    let time = |length: usize| {
        let before = computed(begun);
        work(length);
        computed(begun) - before
    };
    let short: Duration = (0..8).map(|_| time(length)).sum();
    let long = time(8 * length);
    let most = (short * 3).max(Duration::from_millis(50));
    assert!(
        long < most,
        "{what:?} took {short:?} in eight parts and {long:?} as a whole"
    );
}
