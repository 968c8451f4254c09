//! A model behind `fabc serve`: a client's request reaches it complete, and unsupported parts are refused by name.

mod clients;
mod formats;
mod pictures;
mod refusals;
pub mod server;
mod streams;
mod whole;

use super::support::Scripted;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fab_model::calls::Calls;
use fab_model::{Message, Model, ModelError, ModelKind, Part, Png, Reply, Request, Speaker};
use fab_program::{ModelRole, Reasoning, ReasoningLevel};
use fab_standins::Geometric;
use serde_json::{Value, json};
use server::{Server, send};
use std::io::Write;
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Duration;

fn blank(side: u32) -> Png {
    Png::new(fab_picture::png::encode(&image::RgbImage::new(side, side)))
}

fn data_url(png: &Png) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png.bytes()))
}

const CHAT: &str = "/v1/chat/completions";
const RESPONSES: &str = "/v1/responses";

/// A small valid request with one field changed.
fn changed(path: &str, field: &str, value: Value) -> Value {
    let mut body = if path == CHAT {
        json!({ "model": "scripted", "messages": [{ "role": "user", "content": "fold it" }] })
    } else {
        json!({ "model": "scripted", "input": [{ "role": "user", "content": "fold it" }] })
    };
    body[field] = value;
    body
}

/// A conversation with everything that both request forms can express.
fn asked() -> Request {
    let shown = Message {
        speaker: Speaker::User,
        parts: vec![Part::Text("fold it".to_owned()), Part::Image(blank(224))],
    };
    let messages = vec![
        Message::text(Speaker::System, "be brief"),
        shown,
        Message::text(Speaker::Assistant, "no"),
        Message::text(Speaker::User, "again"),
    ];
    let mut request = Request::new(ModelRole::Vision, messages);
    request.temperature = Some(0.25);
    request.top_p = Some(0.5);
    request.max_tokens = Some(77);
    request.reasoning = Some(Reasoning::Level(ReasoningLevel::Low));
    request.repetition = 3;
    request.schema = Some(json!({ "type": "object" }));
    request
}

#[test]
fn a_chat_completion_carries_every_part_of_the_question_to_the_model() {
    let model = Arc::new(Scripted::new(&[r#"{"a": 1}"#; 2]));
    let server = Server::of(model.clone());
    let body = json!({
        "model": "scripted",
        "messages": [
            { "role": "system", "content": "be brief" },
            { "role": "user", "content": [
                { "type": "text", "text": "fold it" },
                { "type": "image_url", "image_url": { "url": data_url(&blank(224)), "detail": "high" } },
            ] },
            { "role": "assistant", "content": "no" },
            { "role": "user", "content": "again" },
        ],
        "temperature": 0.25, "top_p": 0.5, "max_completion_tokens": 77, "seed": 3, "reasoning_effort": "low",
        "response_format": { "type": "json_schema", "json_schema": { "name": "action", "strict": true, "schema": { "type": "object" } } },
        "stream": false, "n": 1, "frequency_penalty": 0.0, "user": "me", "stop": null,
    });
    let (status, answer) = server.post(CHAT, &body);
    assert_eq!(status, 200, "{answer}");
    assert_eq!(*model.asked.lock().unwrap(), [asked()]);
    assert_eq!(answer["choices"][0]["message"]["content"], r#"{"a": 1}"#);
    assert_eq!(answer["choices"][0]["finish_reason"], "stop");
    // By the rule of thumb, the text has 2 + 2 + 1 + 2 tokens, and the picture 59.
    assert_eq!(answer["usage"]["prompt_tokens"], 66);
    assert_eq!(answer["usage"]["completion_tokens"], 2);
    assert_eq!(
        server.post(CHAT, &body),
        (200, answer),
        "equal questions have equal answers"
    );
}

#[test]
fn a_response_carries_every_part_of_the_question_to_the_model() {
    let model = Arc::new(Scripted::new(&[r#"{"a": 1}"#]));
    let server = Server::of(model.clone());
    let body = json!({
        "model": "scripted",
        "instructions": "be brief",
        "input": [
            { "role": "user", "content": [
                { "type": "input_text", "text": "fold it" },
                { "type": "input_image", "image_url": data_url(&blank(224)), "detail": "auto" },
            ] },
            { "type": "message", "role": "assistant", "content": [{ "type": "output_text", "text": "no", "annotations": [] }] },
            { "role": "user", "content": "again" },
        ],
        "temperature": 0.25, "top_p": 0.5, "max_output_tokens": 77, "seed": 3, "reasoning": { "effort": "low", "generate_summary": "auto" }, "store": false, "include": ["reasoning.encrypted_content"],
        "text": { "format": { "type": "json_schema", "name": "action", "strict": true, "schema": { "type": "object" } } },
    });
    let (status, answer) = server.post(RESPONSES, &body);
    assert_eq!(status, 200, "{answer}");
    assert_eq!(*model.asked.lock().unwrap(), [asked()]);
    assert_eq!(answer["output"][0]["content"][0]["text"], r#"{"a": 1}"#);
    assert_eq!(answer["usage"]["input_tokens"], 66);
}

#[test]
fn a_question_of_words_alone_is_one_for_a_text_model() {
    let model = Arc::new(Scripted::new(&["one", "two"]));
    let server = Server::of(model.clone());
    let chat =
        json!({ "model": "scripted", "messages": [{ "role": "user", "content": "fold it" }] });
    assert_eq!(server.post(CHAT, &chat).0, 200);
    assert_eq!(
        server
            .post(
                RESPONSES,
                &json!({ "model": "scripted", "input": "fold it" })
            )
            .0,
        200
    );
    let expected = Request::new(
        ModelRole::Text,
        vec![Message::text(Speaker::User, "fold it")],
    );
    assert_eq!(*model.asked.lock().unwrap(), [expected.clone(), expected]);
}

#[test]
fn models_are_listed_and_other_paths_and_methods_are_refused() {
    let server = Server::of(Arc::new(Geometric));
    let (status, listed) = server.get("/v1/models");
    assert_eq!(
        (status, &listed["data"][0]["id"]),
        (200, &json!("geometric"))
    );
    assert_eq!(listed["data"].as_array().unwrap().len(), 1);
    assert_eq!(server.get("/v1/models/geometric").1["id"], "geometric");
    for (method, path, status) in [
        ("GET", "/v1/models/gpt-4o", 404),
        ("GET", "/v1/files", 404),
        ("GET", CHAT, 405),
        ("POST", "/v1/models", 405),
    ] {
        let (found, answer) = send(server.address, method, path, "");
        assert_eq!(found, status, "{method} {path}");
        assert!(answer["error"]["message"].is_string(), "{answer}");
    }
}

/// Panics at its first question and answers the others.
struct Fragile(Scripted);

impl Model for Fragile {
    fn name(&self) -> &str {
        "scripted"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        assert!(!self.0.asked.lock().unwrap().is_empty() || self.0.ask(request, calls).is_err());
        self.0.ask(request, calls)
    }
}

#[test]
fn a_model_that_fails_or_panics_ends_its_request_and_no_other() {
    let server = Server::of(Arc::new(Fragile(Scripted::new(&["lost", "kept"]))));
    let body = changed(CHAT, "user", json!("me"));
    let (status, answer) = server.post(CHAT, &body);
    assert_eq!(
        (status, &answer["error"]["type"]),
        (500, &json!("server_error"))
    );
    assert_eq!(
        server.post(CHAT, &body).1["choices"][0]["message"]["content"],
        "kept"
    );
    let (status, answer) = server.post(CHAT, &body);
    assert_eq!(status, 400, "{answer}");
    assert!(
        answer["error"]["message"]
            .as_str()
            .unwrap()
            .contains("the script is over")
    );
}

#[test]
fn many_clients_at_once_are_all_answered() {
    let replies = ["yes"; 40];
    let model = Arc::new(Scripted::new(&replies));
    let server = Server::of(model.clone());
    let body = changed(CHAT, "user", json!("me"));
    std::thread::scope(|scope| {
        for _ in 0..replies.len() {
            scope.spawn(|| assert_eq!(server.post(CHAT, &body).0, 200));
        }
    });
    assert_eq!(model.asked.lock().unwrap().len(), replies.len());
}

#[test]
fn a_client_that_hangs_does_not_keep_the_server_from_ending() {
    let server = Server::of(Arc::new(Geometric));
    let mut hanging = TcpStream::connect(server.address).unwrap();
    hanging
        .write_all(b"POST /v1/responses HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 9\r\n\r\n{")
        .unwrap();
    let address = server.address;
    let (ended, wait) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        drop(server);
        let _ = ended.send(());
    });
    // Far longer than the server waits for answers in progress, and shorter than it waits for a body.
    let in_time = wait.recv_timeout(Duration::from_secs(40));
    assert!(in_time.is_ok(), "the server waits for the client");
    assert!(
        TcpStream::connect(address).is_err(),
        "nobody listens any more"
    );
}
