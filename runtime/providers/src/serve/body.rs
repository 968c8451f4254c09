//! Reads the body of a request, bounded in length, time and memory.
//!
//! In: a request. Out: its JSON object, and the place that a long body takes. Short bodies take none, so that they
//! never wait for the long ones of others.

use super::MAX_BODY_BYTES;
use super::refusal::Refusal;
use axum::extract::Request;
use axum::http::StatusCode;
use axum::http::header::CONTENT_LENGTH;
use futures_util::StreamExt;
use serde_json::{Map, Value};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

/// Time limit for a body to arrive, and for its next piece, so that a client that hangs holds no place for ever.
const BODY_TIME: Duration = Duration::from_secs(60);
const STALL_TIME: Duration = Duration::from_secs(10);
/// How long a long body waits for its place.
const PLACE_TIME: Duration = Duration::from_secs(300);
/// The longest body that takes no place, bytes.
const SHORT_BYTES: usize = 4 << 20;
/// The most long bodies in memory.
const LONG_AT_ONCE: usize = 4;
/// The most values in a body: in memory, each takes up to forty times its bytes.
const MAX_VALUES: usize = 1 << 20;

/// The places of long bodies.
#[derive(Clone)]
pub(super) struct Places(Arc<Semaphore>);

impl Places {
    pub(super) fn new() -> Places {
        Places(Arc::new(Semaphore::new(LONG_AT_ONCE)))
    }
}

/// A body that was read.
pub(super) struct Body {
    bytes: Vec<u8>,
    place: Option<OwnedSemaphorePermit>,
}

impl Body {
    /// Reads a body.
    pub(super) async fn read(request: Request, places: &Places) -> Result<Body, Refusal> {
        // Check the declared length first, so that a body that is too long need not be read.
        let declared = request.headers().get(CONTENT_LENGTH);
        let declared = declared.and_then(|value| value.to_str().ok()?.parse::<u64>().ok());
        if declared.is_some_and(|length| length > MAX_BODY_BYTES as u64) {
            return Err(Refusal::body(StatusCode::PAYLOAD_TOO_LARGE, MAX_BODY_BYTES));
        }
        let mut pieces = request.into_body().into_data_stream();
        let mut body = Body {
            bytes: Vec::new(),
            place: None,
        };
        // The wait for a place is not the client's fault, and does not count.
        let mut left = BODY_TIME;
        loop {
            let begun = Instant::now();
            let piece = timeout(left.min(STALL_TIME), pieces.next()).await;
            let piece = piece.map_err(|_| Refusal::too_slow(STALL_TIME, BODY_TIME))?;
            left = left.saturating_sub(begun.elapsed());
            let Some(piece) = piece else { return Ok(body) };
            let piece =
                piece.map_err(|_| Refusal::body(StatusCode::BAD_REQUEST, MAX_BODY_BYTES))?;
            let length = body.bytes.len() + piece.len();
            if length > MAX_BODY_BYTES {
                return Err(Refusal::body(StatusCode::PAYLOAD_TOO_LARGE, MAX_BODY_BYTES));
            }
            if length > SHORT_BYTES && body.place.is_none() {
                let place = timeout(PLACE_TIME, places.0.clone().acquire_owned()).await;
                let place = place.ok().and_then(Result::ok);
                body.place = Some(place.ok_or_else(Refusal::busy)?);
            }
            body.bytes.extend_from_slice(&piece);
        }
    }

    /// Parses the body; returns its fields, and its place, which is to be held as long as they are.
    pub(super) fn parse(
        self,
    ) -> Result<(Map<String, Value>, Option<OwnedSemaphorePermit>), Refusal> {
        let begins_value = |byte: &&u8| matches!(byte, b',' | b':' | b'[' | b'{');
        if self.bytes.iter().filter(begins_value).count() > MAX_VALUES {
            return Err(Refusal::wrong(format!(
                "the body has more than {MAX_VALUES} values"
            )));
        }
        match serde_json::from_slice(&self.bytes) {
            Ok(Value::Object(fields)) => Ok((fields, self.place)),
            Ok(_) => Err(Refusal::wrong("the body is not a JSON object")),
            Err(error) => Err(Refusal::wrong(format!("the body is not JSON: {error}"))),
        }
    }
}
