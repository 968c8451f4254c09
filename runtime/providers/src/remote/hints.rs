//! How long a provider asks clients to wait, from its headers.
//!
//! In: the headers of a reply and the time. Out: a wait of at most a day; `None` if there is no readable hint. The two headers
//! are those that the providers' own clients read.

use reqwest::header::HeaderMap;
use std::time::{Duration, SystemTime};

/// Waits are clamped to this; the retry policy decides whether to wait that long.
const LONGEST: Duration = Duration::from_secs(24 * 3600);

/// Reads `retry-after-ms`, or else `retry-after` in seconds or as a date.
pub(super) fn wait(headers: &HeaderMap, now: SystemTime) -> Option<Duration> {
    let text = |name: &str| headers.get(name)?.to_str().ok();
    let seconds = |name: &str| {
        let number: f64 = text(name)?.trim().parse().ok()?;
        Duration::try_from_secs_f64(number).ok()
    };
    let until = |text: &str| {
        let date = httpdate::parse_http_date(text.trim()).ok()?;
        Some(date.duration_since(now).unwrap_or_default())
    };
    let asked = seconds("retry-after-ms").map(|wait| wait / 1000);
    let asked = asked.or_else(|| seconds("retry-after"));
    let asked = asked.or_else(|| until(text("retry-after")?));
    asked.map(|wait| wait.min(LONGEST))
}

#[cfg(test)]
#[path = "tests/hints.rs"]
mod tests;
