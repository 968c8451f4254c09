//! Requests that are refused: each error names what is wrong, and no model is asked.

use super::server::{Server, exchange, send};
use super::{CHAT, RESPONSES, changed};
use crate::suite::support::Scripted;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use std::sync::Arc;

#[test]
fn what_cannot_be_honoured_is_refused_by_name_and_no_model_is_asked() {
    let model = Arc::new(Scripted::new(&[]));
    let server = Server::of(model.clone());
    let shown = |url: &str| json!([{ "role": "user", "content": [{ "type": "image_url", "image_url": { "url": url } }] }]);
    let input = |url: &str| json!([{ "role": "user", "content": [{ "type": "input_image", "image_url": url }] }]);
    let jpeg = format!(
        "data:image/png;base64,{}",
        STANDARD.encode([0xff, 0xd8, 0xff, 0xe0])
    );

    let strict = |schema: Value| json!({ "type": "json_schema", "json_schema": { "name": "a", "strict": true, "schema": schema } });
    let at = "messages[0].content[0].image_url";

    for (path, field, value, status, param) in [
        (CHAT, "stream", json!("yes"), 400, "stream"),
        (
            CHAT,
            "stream_options",
            json!({ "include_usage": true }),
            400,
            "stream_options",
        ),
        (CHAT, "n", json!(2), 400, "n"),
        (CHAT, "logprobs", json!(true), 400, "logprobs"),
        (CHAT, "top_logprobs", json!(2), 400, "top_logprobs"),
        (CHAT, "audio", json!({ "voice": "any" }), 400, "audio"),
        (
            CHAT,
            "modalities",
            json!(["text", "audio"]),
            400,
            "modalities",
        ),
        (
            CHAT,
            "functions",
            json!([{ "name": "fold" }]),
            400,
            "functions",
        ),
        (CHAT, "tool_choice", json!("required"), 400, "tool_choice"),
        (
            CHAT,
            "web_search_options",
            json!({}),
            400,
            "web_search_options",
        ),
        (
            CHAT,
            "response_format",
            strict(json!({ "type": "string", "format": "date" })),
            400,
            "response_format.json_schema.schema",
        ),
        (CHAT, "tools", json!([{ "type": "function" }]), 400, "tools"),
        (
            CHAT,
            "frequency_penalty",
            json!(0.5),
            400,
            "frequency_penalty",
        ),
        (CHAT, "stop", json!(["x"]), 400, "stop"),
        (CHAT, "temperature", json!(3), 400, "temperature"),
        (CHAT, "temperature", json!("hot"), 400, "temperature"),
        (CHAT, "top_p", json!(-0.1), 400, "top_p"),
        (
            CHAT,
            "reasoning_effort",
            json!("xhigh"),
            400,
            "reasoning_effort",
        ),
        (CHAT, "max_tokens", json!(0), 400, "max_tokens"),
        (CHAT, "seed", json!(-1), 400, "seed"),
        (CHAT, "seed", json!(4_294_967_296_u64), 400, "seed"),
        (
            CHAT,
            "response_format",
            json!({ "type": "json_object" }),
            400,
            "response_format.type",
        ),
        (
            CHAT,
            "response_format",
            json!({ "type": "json_schema", "json_schema": { "name": "a" } }),
            400,
            "response_format.json_schema.schema",
        ),
        (CHAT, "model", json!("gpt-6.2-sol"), 404, "model"),
        (CHAT, "model", json!(null), 400, "model"),
        (CHAT, "messages", json!([]), 400, "messages"),
        (CHAT, "messages", json!("fold it"), 400, "messages"),
        (CHAT, "messages", json!([3]), 400, "messages[0]"),
        (
            CHAT,
            "messages",
            json!([{ "role": "tool", "content": "x" }]),
            400,
            "messages[0].role",
        ),
        (
            CHAT,
            "messages",
            json!([{ "role": "user" }]),
            400,
            "messages[0].content",
        ),
        (
            CHAT,
            "messages",
            json!([{ "role": "user", "content": [{ "type": "input_audio" }] }]),
            400,
            "messages[0].content[0].type",
        ),
        (
            CHAT,
            "messages",
            shown("https://example.org/a.png"),
            400,
            at,
        ),
        (CHAT, "messages", shown("file:///etc/passwd"), 400, at),
        (
            CHAT,
            "messages",
            shown("data:image/jpeg;base64,AAAA"),
            400,
            at,
        ),
        (
            CHAT,
            "messages",
            shown("data:image/webp;base64,AAAA"),
            400,
            at,
        ),
        (CHAT, "messages", shown("data:image/png;base64,!"), 400, at),
        (CHAT, "messages", shown(&jpeg), 400, at),
        (CHAT, "messages", shown("däta"), 400, at),
        (
            RESPONSES,
            "stream_options",
            json!({ "include_obfuscation": true }),
            400,
            "stream_options",
        ),
        (RESPONSES, "tools", json!([{}]), 400, "tools"),
        (
            RESPONSES,
            "include",
            json!(["message.output_text.logprobs"]),
            400,
            "include",
        ),
        (
            RESPONSES,
            "reasoning",
            json!({ "effort": "xhigh" }),
            400,
            "reasoning.effort",
        ),
        (RESPONSES, "background", json!(true), 400, "background"),
        (
            RESPONSES,
            "previous_response_id",
            json!("resp_1"),
            400,
            "previous_response_id",
        ),
        (
            RESPONSES,
            "text",
            json!({ "format": { "type": "grammar" } }),
            400,
            "text.format.type",
        ),
        (RESPONSES, "input", json!(3), 400, "input"),
        (
            RESPONSES,
            "input",
            json!([{ "type": "function_call_output", "output": "x" }]),
            400,
            "input[0].type",
        ),
        (
            RESPONSES,
            "input",
            input("http://example.org/a.png"),
            400,
            "input[0].content[0].image_url",
        ),
        (RESPONSES, "model", json!("geometric"), 404, "model"),
    ] {
        let body = changed(path, field, value);
        let (found, answer) = server.post(path, &body);
        assert_eq!(
            (found, answer["error"]["param"].as_str()),
            (status, Some(param)),
            "{body} {answer}"
        );
        assert_eq!(answer["error"]["type"], "invalid_request_error");
        let message = answer["error"]["message"].as_str().unwrap();
        assert!(!message.is_empty() && !message.ends_with('.'), "{message}");
    }
    let many_values = format!("{{\"model\": [{}0]}}", "0,".repeat(1 << 20));
    let (status, answer) = send(server.address, "POST", CHAT, &many_values);
    assert_eq!(status, 400);
    let message = answer["error"]["message"].as_str().unwrap();
    assert_eq!(message, "the body has more than 1048576 values");
    let both = json!({ "model": "scripted", "messages": [{ "role": "user", "content": "" }], "max_tokens": 1, "max_completion_tokens": 2 });
    assert_eq!(server.post(CHAT, &both).1["error"]["param"], "max_tokens");
    for body in ["", "{", "[]", "3", "\"\\ud800\"", &"[".repeat(100_000)] {
        let (status, answer) = send(server.address, "POST", CHAT, body);
        assert_eq!(status, 400, "{answer}");
    }
    assert!(model.asked.lock().unwrap().is_empty());
}

#[test]
fn other_interfaces_are_named_with_those_that_are_served() {
    let server = Server::of(Arc::new(Scripted::new(&[])));
    for (method, path, named) in [
        ("POST", "/v1/messages", "Anthropic's Messages"),
        ("POST", "/v1/messages/count_tokens", "Anthropic's Messages"),
        ("POST", "/api/chat", "Ollama's own interface"),
        ("GET", "/api/tags", "Ollama's own interface"),
        (
            "POST",
            "/v1beta/models/a:generateContent",
            "Google's Gemini",
        ),
        (
            "POST",
            "/v1/models/a:streamGenerateContent?alt=sse",
            "Google's Gemini",
        ),
        (
            "POST",
            "/v1/completions",
            "completions without a conversation",
        ),
        ("POST", "/v1/embeddings", "embeddings"),
        ("POST", "/chat/completions", "there is no such path"),
        ("GET", "/", "there is no such path"),
    ] {
        let (status, answer) = send(server.address, method, path, "{}");
        let error = &answer["error"];
        assert_eq!(
            (status, &error["type"]),
            (404, &json!("invalid_request_error")),
            "{path}"
        );
        let message = error["message"].as_str().unwrap();
        assert!(message.starts_with(named), "{path}: {message}");
        for served in [CHAT, RESPONSES, "/v1/models"] {
            assert!(message.contains(served), "{path}: {message}");
        }
    }
}

#[test]
#[ignore = "long"]
fn a_body_that_is_too_long_is_refused_before_it_is_sent() {
    let model = Arc::new(Scripted::new(&["read"]));
    let server = Server::of(model.clone());
    let head = |length: usize| {
        format!(
            "POST {CHAT} HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n"
        )
    };
    let too_long = fab_providers::serve::MAX_BODY_BYTES + 1;
    let (status, answer) = exchange(server.address, head(too_long).as_bytes());
    assert_eq!(status, 413, "{answer}");
    assert!(
        answer["error"]["message"]
            .as_str()
            .unwrap()
            .contains("33554432 bytes")
    );
    let long = changed(
        CHAT,
        "messages",
        json!([{ "role": "user", "content": "a".repeat(20 << 20) }]),
    );
    assert_eq!(server.post(CHAT, &long).0, 200);
    assert_eq!(model.asked.lock().unwrap().len(), 1);
}

/// Sends a body with the given header lines.
fn under(server: &Server, method: &str, path: &str, lines: &[&str], body: &Value) -> (u16, Value) {
    let body = body.to_string();
    let mut head = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\n");
    for line in lines {
        head.push_str(&format!("{line}\r\n"));
    }
    let length = body.len();
    let whole = format!("{head}Content-Length: {length}\r\n\r\n{body}");
    exchange(server.address, whole.as_bytes())
}

const JSON: &str = "Content-Type: application/json";

#[test]
fn what_a_page_in_a_browser_could_send_for_another_site_is_refused_and_no_model_is_asked() {
    let model = Arc::new(Scripted::new(&[]));
    let server = Server::of(model.clone());
    let near = "Host: 127.0.0.1:8642";
    let hosts = [
        "example.org",
        "127.0.0.1.example.org",
        "localhost.example.org:8642",
        "localhost@example.org",
        "example.org@localhost",
        "192.168.0.1",
        "0.0.0.0",
        "[::2]",
        "::1",
        "",
    ];
    let hosts = hosts.map(|host| format!("Host: {host}"));
    let mut heads: Vec<(Vec<&str>, &str)> = hosts
        .iter()
        .map(|host| (vec![host.as_str()], "`Host`"))
        .collect();
    heads.push((vec![], "`Host`"));
    heads.push((vec![near, "Host: example.org"], "`Host`"));
    let origins = [
        "https://example.org",
        "http://127.0.0.1.example.org",
        "http://localhost@example.org",
        "null",
        "localhost",
        "file://",
        "ftp://localhost",
        "",
    ];
    let origins = origins.map(|origin| format!("Origin: {origin}"));
    for origin in &origins {
        heads.push((vec![near, origin], "`Origin`"));
    }
    heads.push((
        vec![
            near,
            "Origin: http://localhost",
            "Origin: https://example.org",
        ],
        "`Origin`",
    ));
    for (mut lines, named) in heads {
        lines.push(JSON);
        for (method, path) in [
            ("POST", CHAT),
            ("POST", RESPONSES),
            ("GET", "/v1/models"),
            ("GET", "/v1/models/scripted"),
            ("OPTIONS", CHAT),
            ("GET", "/nothing"),
        ] {
            let body = changed(path, "stream", json!(true));
            let (status, answer) = under(&server, method, path, &lines, &body);
            let error = &answer["error"];
            assert_eq!(
                (status, &error["type"]),
                (403, &json!("invalid_request_error")),
                "{lines:?}"
            );
            let message = error["message"].as_str().unwrap();
            assert!(message.starts_with(named), "{lines:?}: {message}");
        }
    }
    for line in [
        "Accept: application/json",
        "Content-Type: text/plain",
        "Content-Type: application/x-www-form-urlencoded",
        "Content-Type: multipart/form-data; boundary=application/json",
        "Content-Type: text/plain; application/json",
        "Content-Type: application/json-seq",
        "Content-Type:",
    ] {
        for path in [CHAT, RESPONSES] {
            let body = changed(path, "stream", json!(true));
            let (status, answer) = under(&server, "POST", path, &[near, line], &body);
            let error = &answer["error"];
            assert_eq!(
                (status, &error["type"]),
                (415, &json!("invalid_request_error")),
                "{line}"
            );
            assert!(
                error["message"]
                    .as_str()
                    .unwrap()
                    .contains("application/json")
            );
        }
    }
    assert!(model.asked.lock().unwrap().is_empty());
}

#[test]
fn programs_and_pages_of_this_machine_are_answered_under_each_of_its_names() {
    let heads = [
        ["Host: 127.0.0.1", "Accept: */*"],
        ["Host: LocalHost:8642", "Origin: http://localhost:3000"],
        ["Host: [::1]:1", "Origin: https://127.0.0.1"],
        ["host: localhost", "origin: http://[::1]:80"],
    ];
    let server = Server::of(Arc::new(Scripted::new(&["yes"; 8])));
    for [host, other] in heads {
        for kind in [JSON, "content-type: Application/JSON; charset=utf-8"] {
            let body = changed(CHAT, "user", json!("me"));
            let (status, answer) = under(&server, "POST", CHAT, &[host, other, kind], &body);
            assert_eq!(status, 200, "{host}, {other}, {kind}: {answer}");
        }
    }
}
