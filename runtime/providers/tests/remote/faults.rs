//! Tests of error statuses and invalid replies: what is retried, how often, and what is reported.

use crate::support::*;
use fab_model::calls::{Billing, Fault, Usd};
use fab_model::{Model, ModelError, Reply};
use fab_providers::catalogue::Accepted;
use fab_providers::remote::{Wire, most_calls};
use std::time::{Duration, Instant};

fn json(code: u16, body: &str) -> Response {
    status(code).json(body)
}

/// A repeated reply, its fault, and whether the call may have been billed.
fn failures() -> Vec<(Response, Fault, Billing)> {
    use Billing::{No, Possibly};
    let ended = |reason: &str| {
        json(
            200,
            &format!(
                r#"{{"choices":[{{"finish_reason":"{reason}","message":{{"content":"x"}}}}]}}"#
            ),
        )
    };
    let refusal =
        r#"{"choices":[{"finish_reason":"stop","message":{"content":null,"refusal":"no"}}]}"#;
    vec![
        (status(429), Fault::RateLimited, No),
        (
            json(429, r#"{"error":{"code":"insufficient_quota"}}"#),
            Fault::QuotaExhausted,
            No,
        ),
        (status(401), Fault::NotAuthorised, No),
        (status(403), Fault::NotAuthorised, No),
        (status(400), Fault::BadRequest, No),
        (status(404), Fault::BadRequest, No),
        (status(413), Fault::BadRequest, No),
        (status(422), Fault::BadRequest, No),
        (
            status(302).header("location", "http://127.0.0.1:1/"),
            Fault::BadRequest,
            No,
        ),
        (status(500), Fault::ServerFailed, Possibly),
        (status(503), Fault::ServerFailed, No),
        (status(529), Fault::ServerFailed, No),
        (status(408), Fault::TimedOut, Possibly),
        (status(504), Fault::TimedOut, Possibly),
        (json(200, refusal), Fault::Refused, Possibly),
        (ended("content_filter"), Fault::ContentFiltered, Possibly),
        (ended("abort"), Fault::ServerFailed, Possibly),
        (
            json(200, "{\"choices\": [{\"message\": {\"cont"),
            Fault::InvalidReply,
            Possibly,
        ),
        (json(200, "<html></html>"), Fault::InvalidReply, Possibly),
        (json(200, ""), Fault::InvalidReply, Possibly),
        (good("  "), Fault::InvalidReply, Possibly),
    ]
}

#[test]
fn each_failure_is_named_and_tried_as_often_as_its_bound_says() {
    for (reply, fault, billing) in failures() {
        let provider = Provider::playing(vec![reply.clone()]);
        let trial = Trial::of(provider.base_url());
        let mut notes = Notes::new();
        let error = trial.model().ask(&request(), &mut notes).unwrap_err();
        let ModelError::Failed {
            fault: last, why, ..
        } = &error
        else {
            panic!("{error}");
        };
        assert_eq!(*last, fault, "{reply:?}: {why}");
        let count = most_calls(fault) as usize;
        assert_eq!(provider.calls(), count, "{fault}");
        assert_eq!(notes.faults(), vec![(fault, billing); count]);
        assert!(why.contains(&format!("after {count} call")), "{why}");
    }
}

#[test]
fn an_answer_after_failures_is_an_answer_and_each_message_is_told_before_and_after() {
    let replies = vec![status(429), status(500), json(200, "{"), good("there")];
    let provider = Provider::playing(replies);
    let trial = Trial::of(provider.base_url());
    let mut notes = Notes::new();
    let reply = trial.model().ask(&request(), &mut notes).unwrap();
    let cost = Some(Usd::from_nano(150));
    assert_eq!((reply.text.as_str(), reply.cost), ("there", cost));
    let faults = [
        (Fault::RateLimited, Billing::No),
        (Fault::ServerFailed, Billing::Possibly),
        (Fault::InvalidReply, Billing::Possibly),
    ];
    assert_eq!(notes.faults(), faults);
    assert_eq!(
        notes.told[0],
        Told::Begin {
            model: "provider:a-model".to_owned(),
            key: request().key(),
            number: 1,
            at_most: Some(Usd::from_nano(100)),
        }
    );
    let text = "there".to_owned();
    assert_eq!(notes.ends().last(), Some(&Told::Answered { text, cost }));
}

#[test]
fn failures_of_all_kinds_together_are_bounded() {
    let kinds = [429, 500, 504, 503];
    let replies: Vec<_> = (0..40).map(|at| status(kinds[at % 4])).collect();
    let provider = Provider::playing(replies);
    let trial = Trial::of(provider.base_url());
    let mut notes = Notes::new();
    let error = trial.model().ask(&request(), &mut notes);
    assert!(matches!(error, Err(ModelError::Failed { .. })));
    assert!(provider.calls() <= trial.settings.retry.calls as usize);
    assert_eq!(notes.ends().len(), provider.calls());
}

#[test]
fn a_wait_that_the_provider_asks_for_is_kept_where_it_is_longer() {
    let slow = status(429).header("retry-after-ms", "300");
    let provider = Provider::playing(vec![slow, good("there")]);
    let trial = Trial::of(provider.base_url());
    let begun = Instant::now();
    trial.model().ask(&request(), &mut Notes::new()).unwrap();
    assert!(begun.elapsed() >= Duration::from_millis(300));
}

#[test]
fn a_wait_longer_than_the_limit_is_not_waited_for() {
    let reply = status(429).header("retry-after", "7200");
    let provider = Provider::playing(vec![reply]);
    let trial = Trial::of(provider.base_url());
    let error = trial
        .model()
        .ask(&request(), &mut Notes::new())
        .unwrap_err();
    assert!(error.to_string().contains("7200.0 s"), "{error}");
    assert_eq!(provider.calls(), 1);
}

#[test]
fn a_call_that_is_refused_is_not_sent() {
    let provider = Provider::playing(vec![status(500)]);
    let trial = Trial::of(provider.base_url());
    let mut notes = Notes {
        allowed: 2,
        ..Notes::new()
    };
    let error = trial.model().ask(&request(), &mut notes).unwrap_err();
    assert!(matches!(error, ModelError::NotSent(_)), "{error}");
    assert_eq!((provider.calls(), notes.ends().len()), (2, 2));
}

#[test]
fn a_truncated_answer_says_what_it_cost() {
    let body = r#"{"choices":[{"finish_reason":"length","message":{"content":"x"}}],"usage":{"prompt_tokens":3,"completion_tokens":4}}"#;
    let provider = Provider::playing(vec![json(200, body)]);
    let mut notes = Notes::new();
    Trial::of(provider.base_url())
        .model()
        .ask(&request(), &mut notes)
        .unwrap_err();
    let cost = |told: &Told| match told {
        Told::Failed(failed) => failed.cost,
        _ => None,
    };
    let costs: Vec<_> = notes.ends().iter().map(cost).collect();
    assert_eq!(costs, [Some(Usd::from_nano(70))]);
}

#[test]
fn each_provider_gets_its_key_in_its_own_header_at_its_own_address() {
    let cases = [
        (
            Wire::OpenaiChat,
            "/v1/chat/completions",
            "authorization",
            format!("Bearer {CANARY}"),
        ),
        (
            Wire::OpenaiResponses,
            "/v1/responses",
            "authorization",
            format!("Bearer {CANARY}"),
        ),
        (
            Wire::Anthropic,
            "/v1/messages",
            "x-api-key",
            CANARY.to_owned(),
        ),
        (
            Wire::Gemini,
            "/v1beta/models/a-model:generateContent",
            "x-goog-api-key",
            CANARY.to_owned(),
        ),
    ];
    for (wire, path, header, value) in cases {
        let provider = Provider::playing(vec![status(400)]);
        let mut trial = Trial::of(provider.base_url());
        trial.settings.profile.provider.wire = wire;
        let _: Result<Reply, _> = trial.model().ask(&request(), &mut Notes::new());
        let got = provider.questions().remove(0);
        assert_eq!(got.path, path);
        assert_eq!(got.headers[header], value);
        assert_eq!(got.headers["content-type"], "application/json");
        let is_versioned = got.headers.contains_key("anthropic-version");
        assert_eq!(is_versioned, wire == Wire::Anthropic);
        assert_eq!(got.body, trial.model().encoded(&request()).unwrap().body);
    }
}

#[test]
fn a_request_that_does_not_fit_is_neither_sent_nor_told() {
    let provider = Provider::playing(vec![good("there")]);
    let mut trial = Trial::of(provider.base_url());
    trial.settings.profile.facts.temperature = Some(Accepted::Only(vec![1.0]));
    let mut warm = request();
    warm.temperature = Some(0.2);
    let mut notes = Notes::new();
    let error = trial.model().ask(&warm, &mut notes).unwrap_err();
    assert!(matches!(error, ModelError::Unsupported { .. }), "{error}");
    assert!(provider.calls() == 0 && notes.told.is_empty());
}
