//! Requests that are refused: each names what is wrong, and no model is asked.

use super::server::{Server, exchange, send};
use super::{CHAT, RESPONSES, changed};
use crate::suite::support::Scripted;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;
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

    let at = "messages[0].content[0].image_url";

    for (path, field, value, status, param) in [
        (CHAT, "stream", json!(true), 400, "stream"),
        (CHAT, "n", json!(2), 400, "n"),
        (CHAT, "tools", json!([{ "type": "function" }]), 400, "tools"),
        (
            CHAT,
            "frequency_penalty",
            json!(0.5),
            400,
            "frequency_penalty",
        ),
        (CHAT, "stop", json!(["x"]), 400, "stop"),
        (
            CHAT,
            "reasoning_effort",
            json!("high"),
            400,
            "reasoning_effort",
        ),
        (CHAT, "temperature", json!(3), 400, "temperature"),
        (CHAT, "temperature", json!("hot"), 400, "temperature"),
        (CHAT, "top_p", json!(-0.1), 400, "top_p"),
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
        (CHAT, "messages", shown("data:image/png;base64,!"), 400, at),
        (CHAT, "messages", shown(&jpeg), 400, at),
        (CHAT, "messages", shown("däta"), 400, at),
        (RESPONSES, "stream", json!(true), 400, "stream"),
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
    let both = json!({ "model": "scripted", "messages": [{ "role": "user", "content": "" }], "max_tokens": 1, "max_completion_tokens": 2 });
    assert_eq!(server.post(CHAT, &both).1["error"]["param"], "max_tokens");
    for body in ["", "{", "[]", "3", "\"\\ud800\"", &"[".repeat(100_000)] {
        let (status, answer) = send(server.address, "POST", CHAT, body);
        assert_eq!(status, 400, "{answer}");
    }
    assert!(model.asked.lock().unwrap().is_empty());
}

#[test]
fn a_body_that_is_too_long_is_refused_before_it_is_sent() {
    let model = Arc::new(Scripted::new(&["read"]));
    let server = Server::of(model.clone());
    let head = |length: usize| {
        format!(
            "POST {CHAT} HTTP/1.1\r\nHost: x\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n"
        )
    };
    let too_long = runtime::serve::MAX_BODY_BYTES + 1;
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
