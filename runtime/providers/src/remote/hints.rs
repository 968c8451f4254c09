//! How long a provider asks clients to wait, from its headers.
//!
//! In: the headers of a reply and the time. Out: a wait of at most a day; `None` if there is no readable hint.

use reqwest::header::HeaderMap;
use std::time::{Duration, SystemTime};

/// Waits are clamped to this; the retry policy decides whether to wait that long.
const LONGEST: Duration = Duration::from_secs(24 * 3600);

/// Reads `retry-after-ms`, `retry-after`, or else the `x-ratelimit-reset-…` of the exhausted limit.
///
/// Dates are relative to the reply's own `date` if it has one, so a wrong local clock does no harm.
pub(super) fn wait(headers: &HeaderMap, now: SystemTime) -> Option<Duration> {
    let text = |name: &str| headers.get(name).and_then(|value| value.to_str().ok());
    let now = text("date")
        .and_then(|date| httpdate::parse_http_date(date).ok())
        .unwrap_or(now);
    let asked = text("retry-after-ms")
        .and_then(|text| seconds(text).map(|wait| wait / 1000))
        .or_else(|| text("retry-after").and_then(|text| seconds_or_date(text, now)));
    asked
        .or_else(|| reset(headers, now))
        .map(|wait| wait.min(LONGEST))
}

/// Returns when the exhausted limit resets; if none is reported as exhausted, the earliest reset.
fn reset(headers: &HeaderMap, now: SystemTime) -> Option<Duration> {
    let mut first: Option<Duration> = None;
    let mut used_up: Option<Duration> = None;
    for (name, value) in headers {
        let Some(what) = name.as_str().strip_prefix("x-ratelimit-reset-") else {
            continue;
        };
        let Some(wait) = value
            .to_str()
            .ok()
            .and_then(|text| seconds_or_date(text, now))
        else {
            continue;
        };
        first = Some(first.map_or(wait, |first| first.min(wait)));
        let left = headers.get(format!("x-ratelimit-remaining-{what}"));
        if left.is_some_and(|left| left.as_bytes() == b"0") {
            used_up = used_up.max(Some(wait));
        }
    }
    used_up.or(first)
}

fn seconds_or_date(text: &str, now: SystemTime) -> Option<Duration> {
    let span = || humantime::parse_duration(text.trim()).ok();
    seconds(text).or_else(span).or_else(|| {
        let date = httpdate::parse_http_date(text.trim()).ok()?;
        Some(date.duration_since(now).unwrap_or_default())
    })
}

fn seconds(text: &str) -> Option<Duration> {
    let number: f64 = text.trim().parse().ok()?;
    Duration::try_from_secs_f64(number).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use reqwest::header::{HeaderName, HeaderValue};

    fn read(lines: &[(&'static str, &'static str)]) -> Option<f64> {
        let mut headers = HeaderMap::new();
        for (name, value) in lines {
            headers.insert(
                HeaderName::from_static(name),
                HeaderValue::from_static(value),
            );
        }
        // 1994-11-06 08:49:37, from the standard's own example.
        let now = SystemTime::UNIX_EPOCH + Duration::from_secs(784_111_777);
        wait(&headers, now).map(|wait| wait.as_secs_f64())
    }

    #[test]
    fn waits_are_read_in_every_form_that_providers_use() {
        for (lines, expected) in [
            (&[("retry-after", "2")][..], Some(2.0)),
            (&[("retry-after", "0.5")], Some(0.5)),
            (
                &[("retry-after", "20"), ("retry-after-ms", "250")],
                Some(0.25),
            ),
            (
                &[("retry-after", "Sun, 06 Nov 1994 08:50:07 GMT")],
                Some(30.0),
            ),
            (
                &[("retry-after", "Sun, 06 Nov 1994 08:49:07 GMT")],
                Some(0.0),
            ),
            (
                &[
                    ("retry-after", "Sun, 06 Nov 1994 08:50:07 GMT"),
                    ("date", "Sun, 06 Nov 1994 08:50:00 GMT"),
                ],
                Some(7.0),
            ),
            (&[("x-ratelimit-reset-requests", "6m0s")], Some(360.0)),
            (&[("x-ratelimit-reset-tokens", "20ms")], Some(0.02)),
            (
                &[
                    ("x-ratelimit-reset-requests", "12ms"),
                    ("x-ratelimit-remaining-requests", "59"),
                    ("x-ratelimit-reset-tokens", "1m1.5s"),
                    ("x-ratelimit-remaining-tokens", "0"),
                ],
                Some(61.5),
            ),
            (
                &[
                    ("x-ratelimit-reset-requests", "9s"),
                    ("x-ratelimit-reset-tokens", "3s"),
                ],
                Some(3.0),
            ),
            (&[("retry-after", "1e9")], Some(86_400.0)),
            (&[("retry-after", "-3")], None),
            (&[("retry-after", "NaN")], None),
            (&[("retry-after", "soon")], None),
            (&[("retry-after", "")], None),
            (&[], None),
        ] {
            let found = read(lines);
            let close = match (found, expected) {
                (Some(found), Some(expected)) => f64::abs(found - expected) < 1e-6,
                (found, expected) => found == expected,
            };
            assert!(close, "{lines:?}: {found:?}, not {expected:?}");
        }
    }
}
