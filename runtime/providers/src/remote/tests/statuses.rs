//! Tests of providers' error replies, each mapped to a named fault.

use super::*;

/// Status, body, fault, billing, and a word that the message must contain.
const CASES: &[(u16, &str, Fault, Billing, &str)] = {
    use Billing::{No, Possibly};
    use Fault::*;
    &[
        (301, "", BadRequest, No, "base URL"),
        (
            400,
            r#"{"error":{"message":"bad size","type":"invalid_request_error"}}"#,
            BadRequest,
            No,
            "bad size",
        ),
        (
            400,
            r#"{"type":"error","error":{"type":"invalid_request_error","message":"Your credit balance is too low to access the API"}}"#,
            QuotaExhausted,
            No,
            "credit",
        ),
        (
            400,
            r#"[{"error":{"code":400,"message":"API key not valid","status":"INVALID_ARGUMENT","details":[{"reason":"API_KEY_INVALID"}]}}]"#,
            NotAuthorised,
            No,
            "not valid",
        ),
        (
            400,
            r#"{"error":{"code":"content_policy_violation","message":"no"}}"#,
            ContentFiltered,
            No,
            "no",
        ),
        (
            401,
            r#"{"error":{"code":"invalid_api_key","message":"wrong key"}}"#,
            NotAuthorised,
            No,
            "wrong key",
        ),
        (
            402,
            r#"{"error":{"type":"billing_error","message":"pay"}}"#,
            QuotaExhausted,
            No,
            "pay",
        ),
        (
            403,
            "<html>Forbidden\n\n  here</html>",
            NotAuthorised,
            No,
            "<html>Forbidden here</html>",
        ),
        (
            404,
            r#"{"error":"model \"x\" not found"}"#,
            BadRequest,
            No,
            "not found",
        ),
        (408, "", TimedOut, Possibly, "does not say why"),
        (409, "{}", ServerFailed, Possibly, "409"),
        (413, "", BadRequest, No, "413"),
        (
            422,
            r#"{"detail":[{"loc":["body"]}]}"#,
            BadRequest,
            No,
            "422",
        ),
        (
            429,
            r#"{"error":{"message":"Rate limit reached","type":"requests","code":"rate_limit_exceeded"}}"#,
            RateLimited,
            No,
            "reached",
        ),
        (
            429,
            r#"{"error":{"message":"You exceeded your current quota","type":"insufficient_quota","code":"insufficient_quota"}}"#,
            QuotaExhausted,
            No,
            "quota",
        ),
        (
            429,
            r#"{"type":"error","error":{"type":"rate_limit_error","message":"slow down"}}"#,
            RateLimited,
            No,
            "slow",
        ),
        (
            429,
            r#"{"error":{"code":429,"status":"RESOURCE_EXHAUSTED","message":"You exceeded your current quota, check your plan and billing"}}"#,
            QuotaExhausted,
            No,
            "plan",
        ),
        (
            429,
            r#"{"error":{"code":429,"status":"RESOURCE_EXHAUSTED","message":"Resource has been exhausted, try again later"}}"#,
            RateLimited,
            No,
            "later",
        ),
        (
            429,
            r#"{"error":{"status":"RESOURCE_EXHAUSTED","message":"quota","details":[{"violations":[{"quotaId":"RequestsPerDayPerProject"}]},{"retryDelay":"34s"}]}}"#,
            QuotaExhausted,
            No,
            "quota",
        ),
        (429, "", RateLimited, No, "429"),
        (
            500,
            r#"{"error":{"type":"api_error","message":"oops"}}"#,
            ServerFailed,
            Possibly,
            "oops",
        ),
        (502, "bad gateway", ServerFailed, Possibly, "bad gateway"),
        (503, "", ServerFailed, No, "503"),
        (504, "", TimedOut, Possibly, "504"),
        (
            529,
            r#"{"type":"error","error":{"type":"overloaded_error","message":"busy"}}"#,
            ServerFailed,
            No,
            "busy",
        ),
    ]
};

#[test]
fn each_status_and_body_has_its_fault() {
    for (status, body, fault, billing, word) in CASES {
        let refusal = judge(*status, body.as_bytes());
        assert_eq!(
            (refusal.fault, refusal.billing),
            (*fault, *billing),
            "{status} {body}"
        );
        assert!(
            refusal.why.contains(word),
            "{status} {body}: {}",
            refusal.why
        );
    }
}

#[test]
fn a_limit_per_minute_says_how_long_to_wait_and_is_no_exhausted_quota() {
    let body = r#"{"error":{"code":429,"status":"RESOURCE_EXHAUSTED","message":"You exceeded your current quota","details":[
        {"@type":"QuotaFailure","violations":[{"quotaId":"GenerateRequestsPerMinutePerProjectPerModel"}]},
        {"@type":"RetryInfo","retryDelay":"34.5s"}]}}"#;
    let refusal = judge(429, body.as_bytes());
    assert_eq!(refusal.fault, Fault::RateLimited);
    assert_eq!(refusal.wait, Some(Duration::from_millis(34_500)));
}

#[test]
fn messages_of_any_length_are_cut_between_letters() {
    let refusal = judge(500, "ä".repeat(100_000).as_bytes());
    assert_eq!(refusal.why.chars().filter(|c| *c == 'ä').count(), 400);
}
