//! What each failure says: a scripted server plays it, and the message is a snapshot.
//!
//! A case is a row of [`replies`], of [`servers`], or of [`connections`]; its snapshot is named after it. Ports are written as `PORT`.

use crate::support::*;
use fab_model::calls::FailedCall;
use fab_model::{Model, ModelError};
use fab_providers::remote::{BaseUrl, Key, NotListed, Wire, served_models};
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// A failure that a server plays.
struct Case {
    name: &'static str,
    /// The reply to a question, from the status line.
    reply: Vec<u8>,
    wire: Wire,
    /// The names that a key is looked for under, and whether the first one is set.
    keys: (&'static [&'static str], KeySent),
}

#[derive(Clone, Copy, PartialEq)]
enum KeySent {
    Yes,
    No,
}

/// Makes a case: the reply's status with its reason, content type and body.
fn case(name: &'static str, status: &str, kind: &str, body: impl AsRef<[u8]>) -> Case {
    let body = body.as_ref();
    let kind = match kind {
        "" => String::new(),
        "json" => "content-type: application/json\r\n".to_owned(),
        "html" => "content-type: text/html\r\n".to_owned(),
        kind => format!("content-type: {kind}\r\n"),
    };
    let head = format!(
        "HTTP/1.1 {status}\r\n{kind}content-length: {}\r\nconnection: close\r\n\r\n",
        body.len()
    );
    Case {
        name,
        reply: [head.as_bytes(), body].concat(),
        wire: Wire::OpenaiChat,
        keys: (&["A_KEY"], KeySent::Yes),
    }
}

impl Case {
    fn wire(self, wire: Wire) -> Case {
        Case { wire, ..self }
    }

    fn keys(self, names: &'static [&'static str], sent: KeySent) -> Case {
        Case {
            keys: (names, sent),
            ..self
        }
    }

    fn header(mut self, line: &str) -> Case {
        let at = self.reply.windows(2).position(|pair| pair == b"\r\n");
        let at = at.unwrap() + 2;
        self.reply
            .splice(at..at, format!("{line}\r\n").into_bytes());
        self
    }
}

/// Replies, from the general text of the protocol to single servers.
fn replies() -> Vec<Case> {
    let nginx = |reason: &str| {
        format!(
            "<html>\r\n<head><title>{reason}</title></head>\r\n<body>\r\n<center><h1>{reason}</h1></center>\r\n<hr><center>nginx/1.26.3</center>\r\n</body>\r\n</html>\r\n"
        )
    };
    let chat = |message: &str, end: &str| {
        format!(
            r#"{{"object":"chat.completion","choices":[{{"index":0,"message":{message},"finish_reason":"{end}"}}],"usage":{{"prompt_tokens":412,"completion_tokens":64}}}}"#
        )
    };
    let said = |text: &str| format!(r#"{{"role":"assistant","content":"{text}"}}"#);
    vec![
        // Keys.
        case("401_without_a_key", "401 Unauthorized", "json", r#"{"error":"Unauthorized"}"#)
            .keys(&["FABC_VLLM_KEY"], KeySent::No),
        case("401_with_a_wrong_key", "401 Unauthorized", "json", format!(r#"{{"error":{{"message":"Incorrect API key provided: {CANARY}. You can find your API key in your account.","type":"invalid_request_error","param":null,"code":"invalid_api_key"}}}}"#))
            .keys(&["OPENAI_API_KEY"], KeySent::Yes)
            .wire(Wire::OpenaiResponses),
        // Money and limits.
        case("429_quota_used_up", "429 Too Many Requests", "json", r#"{"error":{"message":"You exceeded your current quota, please check your plan and billing details.","type":"insufficient_quota","code":"insufficient_quota"}}"#),
        // The model.
        case("404_model_not_served", "404 Not Found", "json", r#"{"error":{"message":"The model `a-model` does not exist.","type":"NotFoundError","param":"model","code":404}}"#),
        // The address.
        case("404_no_interface", "404 Not Found", "html", nginx("404 Not Found")),
        case("307_to_another_host", "307 Temporary Redirect", "", "")
            .header("location: https://me:canary-pass@models.example/v1/chat/completions?token=canary-token"),
        case("200_login_page", "200 OK", "text/html; charset=utf-8", "<!DOCTYPE html>\n<html><head><title>Sign in</title></head><body>Welcome to the guest network</body></html>"),
        case("200_chat_where_responses_were_asked", "200 OK", "json", chat(&said("fold"), "stop"))
            .wire(Wire::OpenaiResponses),
        // The question.
        case("400_longer_than_the_context", "400 Bad Request", "json", r#"{"error":{"message":"This model's maximum context length is 4096 tokens. However, you requested 5120 tokens (4096 in the messages, 1024 in the completion).","type":"BadRequestError","param":null,"code":400}}"#),
        case("400_no_pictures", "400 Bad Request", "json", r#"{"error":{"message":"At most 0 image(s) may be provided in one prompt.","type":"BadRequestError","param":"image","code":400}}"#),
        case("500_no_projector", "500 Internal Server Error", "json", r#"{"error":{"code":500,"message":"image input is not supported - hint: if this is unexpected, you may need to provide the mmproj","type":"server_error"}}"#),
        case("400_parameter_refused", "400 Bad Request", "json", r#"{"error":{"message":"Unsupported value: 'temperature' does not support 0.2 with this model. Only the default (1) value is supported.","type":"invalid_request_error","param":"temperature","code":"unsupported_value"}}"#),
        case("400_with_control_characters", "400 Bad Request", "text/plain", "bad\x1b[2J request\x07 \u{202e}kcab\r\n\tat line 1"),
        // The server.
        case("503_overloaded", "503 Service Unavailable", "json", r#"{"error":{"message":"The server is busy","type":"server_error"}}"#),
        case("200_with_an_error_in_it", "200 OK", "json", r#"{"error":{"message":"Upstream error from provider","code":502}}"#),
        // What is no answer.
        case("200_stream", "200 OK", "text/event-stream", "data: {\"choices\":[{\"delta\":{\"content\":\"fo\"}}]}\n\ndata: [DONE]\n\n"),
        case("200_no_text", "200 OK", "json", chat(&said(""), "stop")),
        case("200_truncated", "200 OK", "json", chat(&said("fold the left"), "length")),
        case("200_thoughts_cut_off", "200 OK", "json", chat(&said("<think>The cloth lies flat, so"), "length")),
        case("200_text_in_the_field_for_reasoning", "200 OK", "json", chat(r#"{"role":"assistant","content":null,"reasoning_content":"Pick Point = (41, 41)\nPlace Point = (111, 111)"}"#, "stop")),
    ]
}

/// What single servers answer in their own words.
fn servers() -> Vec<Case> {
    vec![
        // vLLM 0.33.0, PyPI's source package: vllm/multimodal/processing/context.py.
        case("vllm_pictures", "400 Bad Request", "json", r#"{"error":{"message":"At most 1 image(s) may be provided in one prompt. Set `--limit-mm-per-prompt` to increase this limit.","type":"BadRequestError","param":"image","code":400}}"#),
        // llama.cpp, as served by xllamacpp 2026.10.11549 from PyPI; `peer_llamacpp` plays it with the server itself.
        case("llamacpp_context", "400 Bad Request", "json", r#"{"error":{"code":400,"message":"request (9026 tokens) exceeds the available context size (2048 tokens), try increasing it","type":"exceed_context_size_error","n_prompt_tokens":9026,"n_ctx":2048}}"#),
        // LiteLLM's proxy, litellm[proxy] 1.106.2 from PyPI without a database; `peer_litellm` plays it with the proxy itself.
        case("litellm_wrong_key", "400 Bad Request", "json", r#"{"error":{"message":"No connected db.","type":"no_db_connection","param":null,"code":"400"}}"#)
            .keys(&["LITELLM_API_KEY"], KeySent::Yes),
    ]
}

/// What a listener does with a connection.
type Act = fn(TcpStream);

/// Connections that come to nothing: what the listener does, and the beginning of the base URL.
fn connections() -> Vec<(&'static str, &'static str, Act)> {
    vec![
        ("no_tls", "https://localhost", |mut stream| {
            // All of it: a connection that is closed with bytes unread is reset, perhaps before the answer is read.
            let mut greeting = [0; 4096];
            let _ = stream.read(&mut greeting);
            say(&mut stream, "HTTP/1.1 400 Bad Request\r\n\r\n");
        }),
        ("self_signed", "https://localhost", |stream| {
            greet(stream, include_bytes!("certificates/self_signed.der"));
        }),
        ("another_service", "http://localhost", |mut stream| {
            Question::read(&mut stream);
            say(&mut stream, "SSH-2.0-OpenSSH_9.9\r\n\r\n");
        }),
        ("cut_within_the_reply", "http://localhost", |mut stream| {
            Question::read(&mut stream);
            say(
                &mut stream,
                "HTTP/1.1 200 OK\r\ncontent-length: 99\r\n\r\n{\"choices\"",
            );
        }),
        ("silent", "http://localhost", |mut stream| {
            Question::read(&mut stream);
            thread::sleep(Duration::from_millis(500));
        }),
    ]
}

/// Begins a TLS session with a certificate, and waits for the other side to end it.
fn greet(mut stream: TcpStream, certificate: &'static [u8]) {
    let key = PrivateKeyDer::try_from(&include_bytes!("certificates/key.der")[..]).unwrap();
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = rustls::ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_no_client_auth()
        .with_single_cert(vec![CertificateDer::from(certificate)], key)
        .unwrap();
    let mut session = rustls::ServerConnection::new(Arc::new(config)).unwrap();
    while session.is_handshaking() && session.complete_io(&mut stream).is_ok() {}
}

/// Listens on a new port and runs `act` on every connection; returns the port.
fn listen(act: impl Fn(TcpStream) + Send + 'static) -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    thread::spawn(move || {
        for stream in listener.incoming() {
            act(stream.unwrap());
        }
    });
    port
}

fn play(case: &Case) -> u16 {
    let reply = case.reply.clone();
    listen(move |mut stream| {
        Question::read(&mut stream).unwrap();
        let _ = stream.write_all(&reply);
    })
}

/// Asks once, and returns the message with `PORT` in place of the port.
fn message(trial: &mut Trial, port: u16) -> String {
    trial.settings.retry.calls = 1;
    let mut notes = Notes::new();
    let error = trial.model().ask(&request(), &mut notes).unwrap_err();
    assert!(matches!(error, ModelError::Failed { .. }), "{error}");
    let message = error.to_string();
    assert!(!message.contains("canary"), "{message}");
    let Some(Told::Failed(FailedCall { why, .. })) = notes.ends().pop() else {
        panic!("{:?}", notes.told);
    };
    let (headline, details) = why.split_once('\n').unwrap();
    assert!(
        message.contains(headline) && message.ends_with(details),
        "{why}"
    );
    message.replace(&port.to_string(), "PORT")
}

fn trial(base: &str) -> Trial {
    let mut trial = Trial::of(base);
    trial.settings.base_url = BaseUrl::parse(base).unwrap();
    trial.settings.profile.provider.key_env = vec!["A_KEY".to_owned()];
    trial
}

#[test]
fn each_reply_says_what_happened_and_what_to_do() {
    let cases: Vec<Case> = replies().into_iter().chain(servers()).collect();
    assert!(cases.len() >= 20);
    for case in &cases {
        let port = play(case);
        let mut trial = trial(&format!("http://127.0.0.1:{port}/v1"));
        let (names, sent) = case.keys;
        trial.settings.profile.provider.wire = case.wire;
        trial.settings.profile.provider.key_env =
            names.iter().map(|name| (*name).to_owned()).collect();
        trial.settings.key = match sent {
            KeySent::Yes => Some(Key::new(names[0], CANARY).unwrap()),
            KeySent::No => None,
        };
        insta::assert_snapshot!(case.name, message(&mut trial, port));
    }
}

#[test]
fn each_connection_that_fails_says_what_happened_and_what_to_do() {
    for (name, base, act) in connections() {
        let port = listen(act);
        let mut trial = trial(&format!("{base}:{port}/v1"));
        if name == "silent" {
            trial.settings.timeout = Duration::from_millis(200);
        }
        let message = message(&mut trial, port);
        // The system's words for a certificate's time have the time of the test in them.
        let message = match message.split_once(": verification time ") {
            Some((before, after)) => format!("{before}: …{}", &after[after.find("\n").unwrap()..]),
            None => message,
        };
        insta::assert_snapshot!(name, message);
    }
}

#[test]
fn a_server_that_is_not_there_comes_with_the_command_that_starts_it() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let mut trial = trial(&format!("http://127.0.0.1:{port}/v1"));
    insta::assert_snapshot!("refused", message(&mut trial, port));
    trial.settings.profile.provider.start = Some("llama-server --model MODEL.gguf".to_owned());
    insta::assert_snapshot!("refused_and_startable", message(&mut trial, port));
}

#[test]
fn a_list_of_models_that_never_ends_is_given_up() {
    let port = listen(|mut stream| {
        Question::read(&mut stream);
        say(&mut stream, "HTTP/1.1 200 OK\r\n\r\n");
        let piece = " ".repeat(1 << 20);
        for _ in 0..40 {
            say(&mut stream, &piece);
        }
    });
    let trial = trial(&format!("http://127.0.0.1:{port}/v1"));
    let listed = served_models(&trial.settings, &trial.shared.interrupt);
    assert!(matches!(listed, Err(NotListed::Other(_))), "{listed:?}");
}

#[test]
fn a_pasted_endpoint_is_refused_with_the_base_that_was_meant() {
    let error = BaseUrl::parse("http://localhost:8000/v1/chat/completions").unwrap_err();
    insta::assert_snapshot!("pasted_endpoint", error);
}
