//! Tests of base URLs that are taken and refused.

use super::*;

fn endpoint(base: &str, wire: Wire) -> String {
    let base = BaseUrl::parse(base).expect("a base URL");
    base.endpoint(wire, "gemini/x y").to_string()
}

#[test]
fn addresses_follow_the_base_and_a_bare_host_gets_the_usual_version() {
    for (base, wire, expected) in [
        (
            "http://localhost:8000",
            Wire::OpenaiChat,
            "http://localhost:8000/v1/chat/completions",
        ),
        (
            "http://localhost:8000/",
            Wire::OpenaiChat,
            "http://localhost:8000/v1/chat/completions",
        ),
        (
            "https://h/a/v9/",
            Wire::OpenaiResponses,
            "https://h/a/v9/responses",
        ),
        (
            "https://h?api-version=2",
            Wire::OpenaiChat,
            "https://h/v1/chat/completions?api-version=2",
        ),
        ("https://h", Wire::Anthropic, "https://h/v1/messages"),
        (
            "https://h",
            Wire::Gemini,
            "https://h/v1beta/models/gemini%2Fx%20y:generateContent",
        ),
    ] {
        assert_eq!(endpoint(base, wire), expected);
    }
}

#[test]
fn a_pasted_endpoint_is_refused_with_the_base_that_was_meant() {
    for (text, endpoint, meant) in [
        (
            "http://h:8000/v1/chat/completions",
            "/chat/completions",
            "http://h:8000/v1",
        ),
        (
            "https://h/v1/chat/completions/",
            "/chat/completions",
            "https://h/v1",
        ),
        (
            "https://h/v1/responses?a=1",
            "/responses",
            "https://h/v1?a=1",
        ),
        ("https://h/v1/messages", "/messages", "https://h/v1"),
        ("https://h/v1/models", "/models", "https://h/v1"),
        ("http://h:11434/api/chat", "/api/chat", "http://h:11434/"),
    ] {
        let error = BaseUrl::parse(text).expect_err(text);
        let ends = format!("ends in `{endpoint}`");
        let write = format!("write `{meant}`");
        assert!(error.contains(&ends) && error.ends_with(&write), "{error}");
    }
    for text in [
        "https://h/api",
        "https://h/api/v1",
        "https://h/openai/deployments/models-x",
        "https://h/responses/v1",
    ] {
        assert!(BaseUrl::parse(text).is_ok(), "{text}");
    }
}

#[test]
fn urls_that_carry_secrets_are_refused_without_repeating_them() {
    for (text, expected) in [
        ("https://me:canary-secret@host/v1", SECRET),
        ("https://canary-secret@host/v1", SECRET),
        ("https://host/v1?key=canary-secret", SECRET),
        ("https://host/v1?x=1&Access_Token=canary-secret", SECRET),
        ("canary-secret", NO_URL),
        ("file:///canary-secret", NO_URL),
        ("", NO_URL),
    ] {
        let error = BaseUrl::parse(text).expect_err("refused");
        assert_eq!(error, expected, "{text}");
        assert!(!error.contains("canary"));
    }
}

#[test]
fn this_computer_is_known_by_name_and_address() {
    for (text, expected) in [
        ("http://localhost:1/v1", true),
        ("http://127.0.0.1:1", true),
        ("http://[::1]:1", true),
        ("http://10.0.0.1", false),
        ("http://localhost.example", false),
    ] {
        assert_eq!(
            BaseUrl::parse(text).map(|url| url.is_loopback()),
            Ok(expected),
            "{text}"
        );
    }
}
