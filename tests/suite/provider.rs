//! A provider for tests: the embedded model behind HTTP, which counts its calls and fails on request.

use axum::body::{Body, Bytes, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use fab_providers::serve;
use fab_standins::Geometric;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;

/// The longest request body of a test.
const MAX_BYTES: usize = 32 << 20;

/// What happens to a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// The embedded model answers.
    Answer,
    /// It answers, and reports that it used this many tokens in and out.
    Reports(u64, u64),
    /// It answers, and reports this many tokens that can be seen and hidden ones.
    Thinks(u64, u64),
    /// Too many calls; no waiting time is given.
    RateLimited,
    /// No credit.
    Quota,
    /// The server is overloaded.
    Overloaded,
    /// No answer for longer than any test waits.
    Silence,
    /// The connection ends in the middle of the answer.
    Cut,
    /// The answer is no JSON.
    Garbage,
    /// The model declines.
    Refusal,
    /// A filter removes the answer.
    Filter,
    /// The answer is cut at its maximum length.
    Truncated,
    /// The key is rejected, and echoed in the message and a header.
    Unauthorised,
}

impl Fate {
    /// Every failure.
    pub const FAILURES: [Fate; 10] = [
        Fate::RateLimited,
        Fate::Quota,
        Fate::Overloaded,
        Fate::Silence,
        Fate::Cut,
        Fate::Garbage,
        Fate::Refusal,
        Fate::Filter,
        Fate::Truncated,
        Fate::Unauthorised,
    ];
}

/// A provider's calls and behaviour.
pub struct Seen {
    /// Bodies of the calls, oldest first.
    pub got: Vec<Vec<u8>>,
    /// How many answers were handed over for sending.
    pub answered: usize,
    /// Decides by a call's number, from 0.
    fate: Box<dyn FnMut(usize) -> Fate + Send>,
    /// Prefix of each answer's text.
    pub said_before: String,
}

/// A running provider; it ends when it is dropped.
pub struct Provider {
    address: String,
    seen: Arc<Mutex<Seen>>,
    _runtime: Runtime,
}

impl Provider {
    /// Starts a provider on a free port of this machine.
    pub fn start(fate: impl FnMut(usize) -> Fate + Send + 'static) -> Provider {
        let seen = Arc::new(Mutex::new(Seen {
            got: Vec::new(),
            answered: 0,
            fate: Box::new(fate),
            said_before: String::new(),
        }));
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .enable_all()
            .build()
            .unwrap();
        let listener = runtime.block_on(TcpListener::bind("127.0.0.1:0")).unwrap();
        let address = format!("http://{}/v1", listener.local_addr().unwrap());
        let router = serve::router(Arc::new(Geometric));
        let layer = middleware::from_fn_with_state(Arc::clone(&seen), meet);
        runtime.spawn(async move { axum::serve(listener, router.layer(layer)).await });
        Provider {
            address,
            seen,
            _runtime: runtime,
        }
    }

    /// Starts one that always answers.
    pub fn reliable() -> Provider {
        Provider::start(|_| Fate::Answer)
    }

    /// Returns the value for `--base-url`.
    pub fn base_url(&self) -> &str {
        &self.address
    }

    /// Returns the calls so far.
    pub fn seen(&self) -> MutexGuard<'_, Seen> {
        self.seen.lock().unwrap()
    }

    /// Returns how often each body was received.
    pub fn counts(&self) -> BTreeMap<Vec<u8>, usize> {
        let mut counts = BTreeMap::new();
        for body in &self.seen().got {
            *counts.entry(body.clone()).or_default() += 1;
        }
        counts
    }
}

async fn meet(State(seen): State<Arc<Mutex<Seen>>>, request: Request, next: Next) -> Response {
    let (parts, body) = request.into_parts();
    let key = key(&parts.headers);
    let bytes = to_bytes(body, MAX_BYTES).await.unwrap();
    let fate = {
        let mut seen = seen.lock().unwrap();
        let number = seen.got.len();
        seen.got.push(bytes.to_vec());
        (seen.fate)(number)
    };
    let failure = |status: u16, kind: &str, message: &str| {
        let body = json!({ "error": { "type": kind, "code": kind, "message": message } });
        (StatusCode::from_u16(status).unwrap(), body.to_string()).into_response()
    };
    let whole = async || {
        let request = Request::from_parts(parts.clone(), Body::from(bytes.clone()));
        let (parts, body) = next.clone().run(request).await.into_parts();
        (parts, to_bytes(body, MAX_BYTES).await.unwrap())
    };
    let reports = async |usage: Value| {
        let (parts, bytes) = whole().await;
        let mut reply: Value = serde_json::from_slice(&bytes).unwrap();
        reply["usage"] = usage;
        let mut response = reply.to_string().into_response();
        *response.status_mut() = parts.status;
        response
    };
    match fate {
        Fate::Answer => {
            let (parts, bytes) = whole().await;
            let mut seen = seen.lock().unwrap();
            seen.answered += 1;
            Response::from_parts(parts, Body::from(with(&seen.said_before, &bytes)))
        }
        Fate::Reports(input, output) => {
            reports(json!({ "prompt_tokens": input, "completion_tokens": output })).await
        }
        Fate::Thinks(visible, hidden) => {
            reports(json!({
                "prompt_tokens": 100,
                "completion_tokens": visible + hidden,
                "completion_tokens_details": { "reasoning_tokens": hidden },
            }))
            .await
        }
        Fate::RateLimited => {
            let mut response = failure(429, "rate_limit_exceeded", "slow down");
            let soon = "0".parse().unwrap();
            response.headers_mut().insert(header::RETRY_AFTER, soon);
            response
        }
        Fate::Quota => failure(429, "insufficient_quota", "you have no credit left"),
        Fate::Overloaded => failure(503, "server_error", "overloaded"),
        Fate::Silence => {
            tokio::time::sleep(Duration::from_secs(3600)).await;
            StatusCode::OK.into_response()
        }
        Fate::Cut => {
            let (_, bytes) = whole().await;
            // The announced length is longer than the stream, which fails.
            let half = bytes.slice(..bytes.len() / 2);
            let pieces = [Ok(half), Err(std::io::Error::other("cut"))];
            let body = Body::from_stream(Pieces(pieces.into_iter()));
            let length = bytes.len().to_string();
            ([(header::CONTENT_LENGTH, length)], body).into_response()
        }
        Fate::Garbage => "<html>bad gateway</html>".into_response(),
        Fate::Refusal => changed(whole().await.1, |choice| {
            choice["message"] = json!({ "role": "assistant", "content": null, "refusal": "no" });
        }),
        Fate::Filter => changed(whole().await.1, |choice| {
            choice["finish_reason"] = json!("content_filter");
        }),
        Fate::Truncated => changed(whole().await.1, |choice| {
            choice["finish_reason"] = json!("length");
        }),
        Fate::Unauthorised => {
            let mut response = failure(401, "invalid_api_key", &format!("wrong key: {key}"));
            if let Ok(value) = key.parse() {
                response.headers_mut().insert("x-your-key", value);
            }
            response
        }
    }
}

/// Parts of a body, one of which fails.
struct Pieces<I>(I);

impl<I: Iterator<Item = std::io::Result<Bytes>> + Unpin> futures_core::Stream for Pieces<I> {
    type Item = std::io::Result<Bytes>;

    fn poll_next(
        mut self: std::pin::Pin<&mut Self>,
        _: &mut std::task::Context<'_>,
    ) -> std::task::Poll<Option<Self::Item>> {
        std::task::Poll::Ready(self.0.next())
    }
}

fn key(headers: &HeaderMap) -> String {
    let value = headers.get(header::AUTHORIZATION);
    let text = value.and_then(|value| value.to_str().ok());
    text.unwrap_or_default().replace("Bearer ", "")
}

fn changed(bytes: Bytes, change: impl Fn(&mut Value)) -> Response {
    let mut reply: Value = serde_json::from_slice(&bytes).unwrap();
    change(&mut reply["choices"][0]);
    reply.to_string().into_response()
}

/// Prefixes the answer's text.
fn with(said_before: &str, bytes: &Bytes) -> Vec<u8> {
    if said_before.is_empty() {
        return bytes.to_vec();
    }
    let mut reply: Value = serde_json::from_slice(bytes).unwrap();
    let content = &mut reply["choices"][0]["message"]["content"];
    if let Some(text) = content.as_str() {
        *content = json!(format!("{said_before}\n{text}"));
    }
    reply.to_string().into_bytes()
}
