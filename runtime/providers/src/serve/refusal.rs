//! Refused requests, in the error format of OpenAI's clients.

use axum::http::StatusCode;
use axum::response::{IntoResponse, Json, Response};
use fab_model::ModelError;
use fab_model::calls::Fault;
use serde_json::json;
use std::time::Duration;

/// Why a request is not answered.
#[derive(Debug, PartialEq)]
pub(super) struct Refusal {
    pub status: StatusCode,
    /// The parameter that is wrong, if it is a single one.
    pub param: Option<String>,
    code: Option<&'static str>,
    pub message: String,
}

impl Refusal {
    fn new(status: StatusCode, message: impl Into<String>) -> Refusal {
        Refusal {
            status,
            param: None,
            code: None,
            message: message.into(),
        }
    }

    /// The request is wrong as a whole.
    pub(super) fn wrong(message: impl Into<String>) -> Refusal {
        Refusal::new(StatusCode::BAD_REQUEST, message)
    }

    /// A parameter is wrong.
    pub(super) fn of(param: impl Into<String>, message: impl Into<String>) -> Refusal {
        Refusal {
            param: Some(param.into()),
            ..Refusal::wrong(message)
        }
    }

    /// A parameter is not supported.
    pub(super) fn unsupported(param: &str, message: impl Into<String>) -> Refusal {
        Refusal {
            code: Some("unsupported_parameter"),
            ..Refusal::of(param, message)
        }
    }

    pub(super) fn no_model(name: &str, served: &str) -> Refusal {
        let name: String = name.chars().take(80).collect();
        Refusal {
            param: Some("model".to_owned()),
            code: Some("model_not_found"),
            ..Refusal::not_found(format!("there is no model `{name}`; `{served}` is served"))
        }
    }

    pub(super) fn not_found(message: impl Into<String>) -> Refusal {
        Refusal::new(StatusCode::NOT_FOUND, message)
    }

    pub(super) fn wrong_method(message: &str) -> Refusal {
        Refusal::new(StatusCode::METHOD_NOT_ALLOWED, message)
    }

    /// The request comes from another host, or addresses one.
    pub(super) fn forbidden(message: &str) -> Refusal {
        Refusal::new(StatusCode::FORBIDDEN, message)
    }

    pub(super) fn wrong_type() -> Refusal {
        let message = "the body's `Content-Type` has to be application/json";
        Refusal::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, message)
    }

    /// The body came too slowly: nothing of it for the time of a `piece`, or not all of it in the `whole` time.
    pub(super) fn too_slow(piece: Duration, whole: Duration) -> Refusal {
        let message = format!(
            "the body came too slowly: its next piece has to arrive within {} s, and all of it within {} s",
            piece.as_secs(),
            whole.as_secs()
        );
        Refusal::new(StatusCode::REQUEST_TIMEOUT, message)
    }

    /// There is no room for the body.
    pub(super) fn busy() -> Refusal {
        let message = "too many long requests at once; send this one again later";
        Refusal::new(StatusCode::SERVICE_UNAVAILABLE, message)
    }

    /// The body could not be read; `status` says whether it is too large.
    pub(super) fn body(status: StatusCode, max_bytes: usize) -> Refusal {
        let message = match status {
            StatusCode::PAYLOAD_TOO_LARGE => {
                format!("the body is longer than the limit of {max_bytes} bytes")
            }
            _ => "the body did not arrive whole".to_owned(),
        };
        Refusal::new(status, message)
    }

    pub(super) fn failed(message: impl Into<String>) -> Refusal {
        Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, message)
    }
}

impl From<ModelError> for Refusal {
    fn from(error: ModelError) -> Refusal {
        let status = match &error {
            ModelError::Unsupported { .. } => StatusCode::BAD_REQUEST,
            ModelError::Failed {
                fault: Fault::RateLimited | Fault::QuotaExhausted,
                ..
            }
            | ModelError::NotSent(_) => StatusCode::TOO_MANY_REQUESTS,
            ModelError::Failed { .. } => StatusCode::BAD_GATEWAY,
            ModelError::Interrupted => StatusCode::SERVICE_UNAVAILABLE,
        };
        Refusal::new(status, error.to_string())
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let kind = match self.status {
            StatusCode::TOO_MANY_REQUESTS => "rate_limit_error",
            status if status.is_server_error() => "server_error",
            _ => "invalid_request_error",
        };
        let error = json!({ "message": self.message, "type": kind, "param": self.param, "code": self.code });
        (self.status, Json(json!({ "error": error }))).into_response()
    }
}
