//! Tests of the waits that headers ask for.

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
