//! Tests of providers' error replies, each mapped to a named fault.

use super::*;
use std::time::Duration;

/// Status, body, fault, billing.
const CASES: &[(u16, &str, Fault, Billing)] = {
    use Billing::{No, Possibly};
    use Fault::*;
    &[
        (301, "", BadRequest, No),
        (
            400,
            r#"{"error":{"message":"bad size","type":"invalid_request_error"}}"#,
            BadRequest,
            No,
        ),
        (
            400,
            r#"{"type":"error","error":{"type":"invalid_request_error","message":"Your credit balance is too low to access the API"}}"#,
            QuotaExhausted,
            No,
        ),
        (
            400,
            r#"[{"error":{"code":400,"message":"API key not valid","status":"INVALID_ARGUMENT","details":[{"reason":"API_KEY_INVALID"}]}}]"#,
            NotAuthorised,
            No,
        ),
        (
            400,
            r#"{"error":{"code":"content_policy_violation","message":"no"}}"#,
            ContentFiltered,
            No,
        ),
        (
            401,
            r#"{"error":{"code":"invalid_api_key","message":"wrong key"}}"#,
            NotAuthorised,
            No,
        ),
        (
            402,
            r#"{"error":{"type":"billing_error","message":"pay"}}"#,
            QuotaExhausted,
            No,
        ),
        (403, "<html>Forbidden\n\n  here</html>", NotAuthorised, No),
        (404, r#"{"error":"model \"x\" not found"}"#, BadRequest, No),
        (408, "", TimedOut, Possibly),
        (409, "{}", ServerFailed, Possibly),
        (413, "", BadRequest, No),
        (422, r#"{"detail":[{"loc":["body"]}]}"#, BadRequest, No),
        (
            429,
            r#"{"error":{"message":"Rate limit reached","type":"requests","code":"rate_limit_exceeded"}}"#,
            RateLimited,
            No,
        ),
        (
            429,
            r#"{"error":{"message":"You exceeded your current quota","type":"insufficient_quota","code":"insufficient_quota"}}"#,
            QuotaExhausted,
            No,
        ),
        (
            429,
            r#"{"type":"error","error":{"type":"rate_limit_error","message":"slow down"}}"#,
            RateLimited,
            No,
        ),
        (
            429,
            r#"{"error":{"code":429,"status":"RESOURCE_EXHAUSTED","message":"You exceeded your current quota, check your plan and billing"}}"#,
            QuotaExhausted,
            No,
        ),
        (
            429,
            r#"{"error":{"code":429,"status":"RESOURCE_EXHAUSTED","message":"Resource has been exhausted, try again later"}}"#,
            RateLimited,
            No,
        ),
        (
            429,
            r#"{"error":{"status":"RESOURCE_EXHAUSTED","message":"quota","details":[{"violations":[{"quotaId":"RequestsPerDayPerProject"}]},{"retryDelay":"34s"}]}}"#,
            QuotaExhausted,
            No,
        ),
        (429, "", RateLimited, No),
        (
            500,
            r#"{"error":{"type":"api_error","message":"oops"}}"#,
            ServerFailed,
            Possibly,
        ),
        (
            500,
            r#"{"error":{"code":500,"message":"image input is not supported - hint: if this is unexpected, you may need to provide the mmproj","type":"server_error"}}"#,
            BadRequest,
            No,
        ),
        (502, "bad gateway", ServerFailed, Possibly),
        (503, "", ServerFailed, No),
        (504, "", TimedOut, Possibly),
        (
            529,
            r#"{"type":"error","error":{"type":"overloaded_error","message":"busy"}}"#,
            ServerFailed,
            No,
        ),
    ]
};

#[test]
fn each_status_and_body_has_its_fault() {
    for (status, body, fault, billing) in CASES {
        let judged = judge(*status, &ErrorBody::of_bytes(body.as_bytes()));
        assert_eq!(judged, (*fault, *billing), "{status} {body}");
    }
}

#[test]
fn a_limit_per_minute_says_how_long_to_wait_and_is_no_exhausted_quota() {
    let body = r#"{"error":{"code":429,"status":"RESOURCE_EXHAUSTED","message":"You exceeded your current quota","details":[
        {"@type":"QuotaFailure","violations":[{"quotaId":"GenerateRequestsPerMinutePerProjectPerModel"}]},
        {"@type":"RetryInfo","retryDelay":"34.5s"}]}}"#;
    let error = ErrorBody::of_bytes(body.as_bytes());
    assert_eq!(judge(429, &error).0, Fault::RateLimited);
    assert_eq!(error.wait, Some(Duration::from_millis(34_500)));
}

#[test]
fn messages_of_any_length_are_cut_between_letters() {
    let body = serde_json::json!({ "error": { "message": "ä".repeat(100_000) } });
    let error = ErrorBody::of_bytes(body.to_string().as_bytes());
    assert_eq!(error.message.chars().filter(|c| *c == 'ä').count(), 400);
}
