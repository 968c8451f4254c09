//! Serves a model as an OpenAI-compatible endpoint on this machine.
//!
//! In: a [`Model`], and HTTP requests from this machine only; requests of foreign web pages in a local browser are
//! refused. Out: its answers, in the formats of OpenAI's Chat Completions and Responses, whole or as a stream of
//! events. A parameter that would change the answer but is not supported is refused by name, never dropped. Token
//! counts are estimates, unless the model reports its own. The command chooses the model and prints messages.

mod answer;
mod body;
mod chat;
mod connections;
mod content;
mod fields;
mod format;
mod paths;
mod picture;
mod refusal;
mod responses;
mod same_origin;
mod schema;

use answer::Answer;
use axum::Router;
use axum::extract::{Path, State};
use axum::http::HeaderValue;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::middleware::{Next, from_fn};
use axum::response::{IntoResponse, Json, Response};
use axum::routing::{get, post};
use body::{Body, Places};
use fab_base::interrupt::Interrupt;
use fab_model::calls::Unrecorded;
use fab_model::{Model, Request};
use fields::Fields;
use format::Format;
use futures_util::stream;
use refusal::Refusal;
use serde_json::{Value, json};
use std::convert::Infallible;
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::Semaphore;

/// The longest request body, bytes.
pub const MAX_BODY_BYTES: usize = 32 << 20;
/// The most requests decoded and answered at once; others wait in the order in which they came.
const AT_ONCE: usize = 16;
/// Fields without effect on the answer, in both formats.
const HARMLESS: [&str; 8] = [
    "user",
    "metadata",
    "store",
    "service_tier",
    "parallel_tool_calls",
    "prompt_cache_key",
    "prompt_cache_retention",
    "safety_identifier",
];
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
        connections::answer(listener, router(model), interrupt).await;
        Ok(())
    });
    runtime.shutdown_background();
    served
}

/// Shared by all handlers.
#[derive(Clone)]
struct Served {
    model: Arc<dyn Model>,
    bodies: Places,
    at_once: Arc<Semaphore>,
}

/// Makes the endpoints: `POST /v1/chat/completions`, `POST /v1/responses`, `GET /v1/models` and `/v1/models/NAME`.
pub fn router(model: Arc<dyn Model>) -> Router {
    let served = Served {
        model,
        bodies: Places::new(),
        at_once: Arc::new(Semaphore::new(AT_ONCE)),
    };
    Router::new()
        .route("/v1/chat/completions", post(answer::<chat::Chat>))
        .route("/v1/responses", post(answer::<responses::Responses>))
        .route("/v1/models", get(models))
        .route("/v1/models/{*name}", get(one_model))
        .fallback(paths::unknown)
        .method_not_allowed_fallback(paths::wrong_method)
        .layer(from_fn(from_near))
        .with_state(served)
}

async fn from_near(request: axum::extract::Request, next: Next) -> Response {
    match same_origin::check(request.headers()) {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    }
}

/// A question, and how it is to be answered.
struct Asked {
    request: Request,
    format: Format,
    is_streamed: bool,
}

/// The format of requests and answers of one endpoint, with the fields that an answer echoes.
trait Form: Sized + Send + 'static {
    /// Reads a body without its model field.
    fn read(fields: Fields) -> Result<(Asked, Self), Refusal>;

    /// Writes an answer as one document.
    fn whole(&self, answer: &Answer) -> Value;

    /// Writes an answer as events.
    fn events(self, answer: Answer) -> impl Iterator<Item = Sent> + Send + 'static;
}

/// An event as it is sent.
struct Sent(String);

impl Sent {
    /// An event without a name.
    fn data(data: &Value) -> Sent {
        // Some clients end a line at these letters, too; inside JSON strings they may be escaped.
        let data = data.to_string();
        let data = data.replace('\u{85}', "\\u0085");
        let data = data.replace('\u{2028}', "\\u2028");
        Sent(format!("data: {}\n\n", data.replace('\u{2029}', "\\u2029")))
    }

    /// An event named by its type.
    fn event(data: &Value) -> Sent {
        let name = data["type"].as_str().unwrap_or_default();
        Sent(format!("event: {name}\n{}", Sent::data(data).0))
    }

    /// The end of a stream of chunks.
    fn end() -> Sent {
        Sent("data: [DONE]\n\n".to_owned())
    }
}

async fn answer<F: Form>(
    State(served): State<Served>,
    request: axum::extract::Request,
) -> Result<Response, Refusal> {
    same_origin::check_type(request.headers())?;
    let body = Body::read(request, &served.bodies).await?;
    let place = served.at_once.acquire_owned().await;
    let place = place.map_err(|_| Refusal::failed("the server is about to end"))?;
    let work = move || {
        let _place = place;
        let (body, _body_place) = body.parse()?;
        let model = served.model.as_ref();
        let mut fields = Fields::new("", body);
        let name = fields.text("model")?;
        if name != model.name() {
            return Err(Refusal::no_model(&name, model.name()));
        }
        let (asked, form) = F::read(fields)?;
        // The model answers before the first byte is sent, so its failure has a status of its own in a stream, too.
        let reply = model.ask(&asked.request, &mut Unrecorded)?;
        let answer = Answer::new(model.name(), &asked.request, reply, &asked.format);
        Ok(match asked.is_streamed {
            false => Json(form.whole(&answer)).into_response(),
            true => streamed(form.events(answer)),
        })
    };
    let worked = tokio::task::spawn_blocking(work).await;
    worked.map_err(|_| Refusal::failed("the model failed on this request"))?
}

/// Sends events one by one, as fast as the client reads them.
fn streamed(events: impl Iterator<Item = Sent> + Send + 'static) -> Response {
    let events = stream::iter(events.map(|Sent(text)| Ok::<_, Infallible>(text)));
    let mut response = Response::new(axum::body::Body::from_stream(events));
    let headers = response.headers_mut();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static("text/event-stream"));
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    response
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
