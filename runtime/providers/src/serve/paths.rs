//! Paths that are not served, with the interface that a client expects there.

use super::refusal::Refusal;
use axum::http::{Method, Uri};

/// A part of a path, and the interface that it belongs to.
const FOREIGN: [(&str, &str); 10] = [
    ("/v1/messages", "Anthropic's Messages"),
    ("/v1/complet", "completions without a conversation"),
    ("/api/", "Ollama's own interface"),
    ("/v1beta/", "Google's Gemini"),
    ("enerateContent", "Google's Gemini"),
    ("/v1/embeddings", "embeddings"),
    ("/v1/audio", "audio"),
    ("/v1/images", "making pictures"),
    ("/v1/files", "files"),
    ("/v1/batches", "batches"),
];

const SERVED: &str =
    "POST /v1/chat/completions and POST /v1/responses answer, GET /v1/models lists the model";

/// Refuses a path that does not exist.
pub(super) async fn unknown(uri: Uri) -> Refusal {
    refusal(uri.path())
}

/// Refuses a method; a path of another interface is refused as such.
pub(super) async fn wrong_method(method: Method, uri: Uri) -> Refusal {
    match foreign(uri.path()) {
        Some(_) => refusal(uri.path()),
        None => Refusal::wrong_method(&format!("{method} is not for this path: {SERVED}")),
    }
}

fn foreign(path: &str) -> Option<&'static str> {
    let mut rows = FOREIGN.iter();
    let (_, interface) = rows.find(|(part, _)| path.contains(part))?;
    Some(interface)
}

fn refusal(path: &str) -> Refusal {
    Refusal::not_found(match foreign(path) {
        Some(interface) => {
            format!("{interface}: this interface is not served here; {SERVED}")
        }
        None => format!("there is no such path; {SERVED}"),
    })
}
