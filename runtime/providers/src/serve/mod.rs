//! Serves a model as an OpenAI-compatible endpoint on this machine.
//!
//! In: a [`Model`], and HTTP requests from this machine only; requests of foreign web pages in a local browser are
//! refused. Out: its answers, in the formats of OpenAI's Chat Completions and Responses. A parameter that would change
//! the answer but is not supported is refused by name, never dropped. Token counts are estimates, unless the model
//! reports its own. The command chooses the model and prints messages.

mod answer;
mod chat;
mod content;
mod fields;
mod refusal;
mod responses;
mod same_origin;

use axum::Router;
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, FromRequest, Path, State};
use axum::http::StatusCode;
use axum::http::header::CONTENT_LENGTH;
use axum::middleware::{Next, from_fn};
use axum::response::{IntoResponse, Json, Response};
use axum::routing::{get, post};
use fab_base::interrupt::Interrupt;
use fab_model::calls::Unrecorded;
use fab_model::{Model, Reply, Request};
use fields::Fields;
use refusal::Refusal;
use serde_json::{Value, json};
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::Semaphore;

/// The longest request body, bytes.
pub const MAX_BODY_BYTES: usize = 32 << 20;
/// The most requests held in memory and answered at once; others wait.
const AT_ONCE: usize = 8;
/// Fields without effect on the answer, in both formats.
const HARMLESS: [&str; 6] = [
    "user",
    "metadata",
    "store",
    "service_tier",
    "prompt_cache_key",
    "safety_identifier",
];
/// Time limit for a body to arrive, so that a hanging connection does not hold a slot for ever.
const BODY_TIME: Duration = Duration::from_secs(60);
/// Time limit for answers in progress at shutdown.
const LAST_TIME: Duration = Duration::from_secs(5);
/// How often the server checks for shutdown.
const LOOK_TIME: Duration = Duration::from_millis(50);

/// Why a model cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The port is unavailable.
    #[error("cannot listen on 127.0.0.1:{port}: {why}; `--port 0` takes any free port")]
    NoPort {
        /// The port.
        port: u16,
        /// The system's error.
        why: io::Error,
    },
    /// The system refused a thread or timer, or ended the server.
    #[error("the server failed: {0}")]
    Failed(#[from] io::Error),
}

/// Serves a model on 127.0.0.1 until `interrupt` is raised; answers in progress are still completed.
///
/// - `port`: 0 takes any free port.
/// - `ready`: told the address as soon as connections are accepted.
pub fn serve(
    model: Arc<dyn Model>,
    port: u16,
    interrupt: &Interrupt,
    ready: &mut dyn FnMut(SocketAddr),
) -> Result<(), ServeError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_io()
        .enable_time()
        .build()?;
    let served = runtime.block_on(async {
        let listener = tokio::net::TcpListener::bind((Ipv4Addr::LOCALHOST, port))
            .await
            .map_err(|why| ServeError::NoPort { port, why })?;
        ready(listener.local_addr()?);
        let raised = interrupt.clone();
        let ended = async move { until_raised(&raised).await };
        let server = axum::serve(listener, router(model)).with_graceful_shutdown(ended);
        let mut server = tokio::spawn(async move { server.await });
        loop {
            match tokio::time::timeout(LOOK_TIME, &mut server).await {
                Ok(ended) => return Ok(ended.map_err(io::Error::other)??),
                Err(_) if interrupt.is_raised() => break,
                Err(_) => {}
            }
        }
        // After a while, do not wait any longer for a client to disconnect.
        let _ = tokio::time::timeout(LAST_TIME, server).await;
        Ok(())
    });
    runtime.shutdown_background();
    served
}

async fn until_raised(interrupt: &Interrupt) {
    while !interrupt.is_raised() {
        tokio::time::sleep(LOOK_TIME).await;
    }
}

/// Shared by all handlers.
#[derive(Clone)]
struct Served {
    model: Arc<dyn Model>,
    places: Arc<Semaphore>,
}

/// Makes the endpoints: `POST /v1/chat/completions`, `POST /v1/responses`, `GET /v1/models` and `/v1/models/NAME`.
pub fn router(model: Arc<dyn Model>) -> Router {
    let served = Served {
        model,
        places: Arc::new(Semaphore::new(AT_ONCE)),
    };
    Router::new()
        .route("/v1/chat/completions", post(chat_completions))
        .route("/v1/responses", post(answer_responses))
        .route("/v1/models", get(models))
        .route("/v1/models/{*name}", get(one_model))
        .fallback(async || Refusal::not_found("there is no such path; there are /v1/chat/completions, /v1/responses and /v1/models"))
        .method_not_allowed_fallback(async || Refusal::wrong_method())
        .layer(DefaultBodyLimit::max(MAX_BODY_BYTES))
        .layer(from_fn(from_near))
        .with_state(served)
}

async fn from_near(request: axum::extract::Request, next: Next) -> Response {
    match same_origin::check(request.headers()) {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    }
}

/// A request in one of the two formats, with the fields that its answer echoes.
trait Form: Sized + Send + 'static {
    /// Reads a body without its model field.
    fn read(fields: Fields) -> Result<(Request, Self), Refusal>;

    /// Writes the answer.
    fn write(&self, request: &Request, reply: &Reply, model: &str) -> Value;
}

async fn chat_completions(state: State<Served>, request: axum::extract::Request) -> Response {
    answer::<chat::Chat>(state, request).await
}

async fn answer_responses(state: State<Served>, request: axum::extract::Request) -> Response {
    answer::<responses::Responses>(state, request).await
}

async fn answer<F: Form>(
    State(served): State<Served>,
    request: axum::extract::Request,
) -> Response {
    match try_answer::<F>(served, request).await {
        Ok(value) => Json(value).into_response(),
        Err(refusal) => refusal.into_response(),
    }
}

async fn try_answer<F: Form>(
    served: Served,
    request: axum::extract::Request,
) -> Result<Value, Refusal> {
    same_origin::check_type(request.headers())?;
    let place = served.places.acquire_owned().await;
    let place = place.map_err(|_| Refusal::failed("the server is about to end"))?;
    // Check the declared length first, so that a body that is too large need not be read.
    let length = request.headers().get(CONTENT_LENGTH);
    let length = length.and_then(|value| value.to_str().ok()?.parse::<u64>().ok());
    if length.is_some_and(|length| length > MAX_BODY_BYTES as u64) {
        return Err(Refusal::body(StatusCode::PAYLOAD_TOO_LARGE, MAX_BODY_BYTES));
    }
    let body = tokio::time::timeout(BODY_TIME, Bytes::from_request(request, &()))
        .await
        .map_err(|_| Refusal::timed_out(BODY_TIME))?
        .map_err(|rejected| Refusal::body(rejected.status(), MAX_BODY_BYTES))?;
    let work = move || {
        let _place = place;
        let body = match serde_json::from_slice(&body) {
            Ok(Value::Object(body)) => body,
            Ok(_) => return Err(Refusal::wrong("the body is not a JSON object")),
            Err(error) => return Err(Refusal::wrong(format!("the body is not JSON: {error}"))),
        };
        let model = served.model.as_ref();
        let mut fields = Fields::new("", body);
        let asked = fields.text("model")?;
        if asked != model.name() {
            return Err(Refusal::no_model(&asked, model.name()));
        }
        let (request, form) = F::read(fields)?;
        let reply = model
            .ask(&request, &mut Unrecorded)
            .map_err(Refusal::from)?;
        Ok(form.write(&request, &reply, model.name()))
    };
    let worked = tokio::task::spawn_blocking(work).await;
    worked.map_err(|_| Refusal::failed("the model failed on this request"))?
}

async fn models(State(served): State<Served>) -> Response {
    Json(json!({ "object": "list", "data": [described(served.model.name())] })).into_response()
}

async fn one_model(State(served): State<Served>, Path(name): Path<String>) -> Response {
    match name == served.model.name() {
        true => Json(described(&name)).into_response(),
        false => Refusal::no_model(&name, served.model.name()).into_response(),
    }
}

fn described(name: &str) -> Value {
    json!({ "id": name, "object": "model", "created": 0, "owned_by": "fabc" })
}
