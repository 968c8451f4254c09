//! Parses providers' errors.
//!
//! In: the `error` of a reply, in any of the providers' formats, and the HTTP status if there is one. Out: a [`Fault`],
//! a message, and how long to wait if the provider says so.

use super::Failure;
use fab_base::wording::shown;
use fab_model::calls::{Fault, Usage};
use serde_json::Value;
use std::time::Duration;

/// The longest provider message that is repeated, characters.
const MAX_MESSAGE: usize = 400;

/// The longest identifier that is repeated, characters.
const MAX_NAME: usize = 60;

/// How much of a body is searched for words, bytes.
const MAX_SEARCHED: usize = 16 * 1024;

/// A provider's error.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::remote) struct ErrorBody {
    /// Its message on one line; empty if it has none, or is not JSON.
    pub(in crate::remote) message: String,
    /// Its whole message, or a body that is not JSON; lower case.
    said: String,
    /// The beginning of the body, lower case.
    text: String,
    /// All its identifiers: types, codes, reasons, quotas; lower case.
    names: Vec<String>,
    /// A numeric code, meant as an HTTP status.
    code: Option<u16>,
    /// The parameter that it objects to.
    pub(in crate::remote) parameter: Option<String>,
    /// The longest wait that it asks for.
    pub(in crate::remote) wait: Option<Duration>,
}

impl ErrorBody {
    /// Reads a whole body; if it is not JSON, only its text is searched.
    pub(in crate::remote) fn of_bytes(bytes: &[u8]) -> ErrorBody {
        let searched = &bytes[..bytes.len().min(MAX_SEARCHED)];
        let text = String::from_utf8_lossy(searched).to_lowercase();
        let Ok(value) = serde_json::from_slice::<Value>(bytes) else {
            return ErrorBody {
                said: text.clone(),
                text,
                ..ErrorBody::default()
            };
        };
        let first = value.get(0).unwrap_or(&value);
        let of_a_choice = || first["choices"].get(0)?.get("error");
        let error = ["error", "detail"].iter().find_map(|name| first.get(name));
        let error = error.or_else(of_a_choice);
        ErrorBody {
            text,
            ..ErrorBody::of(error.unwrap_or(first))
        }
    }

    /// Reads the value of `error`.
    pub(in crate::remote) fn of(error: &Value) -> ErrorBody {
        // FastAPI lists what it finds wrong with a request.
        let message = |value: &Value| {
            let text = value["message"].as_str().or(value["msg"].as_str());
            text.or(value.as_str()).map(str::to_owned)
        };
        let message = message(error)
            .or_else(|| message(error.get(0)?))
            .unwrap_or_default();
        let mut body = ErrorBody {
            said: joined(&message).to_lowercase(),
            message: repeated(&message),
            code: code(&error["code"]),
            parameter: error["param"].as_str().map(|name| shown(name, MAX_NAME)),
            ..ErrorBody::default()
        };
        body.take_names(error);
        for detail in error["details"].as_array().into_iter().flatten() {
            body.take_names(detail);
            for violation in detail["violations"].as_array().into_iter().flatten() {
                body.take_names(violation);
            }
            let wait = detail["retryDelay"].as_str().and_then(|text| {
                let seconds: f64 = text.strip_suffix('s')?.parse().ok()?;
                Duration::try_from_secs_f64(seconds).ok()
            });
            body.wait = body.wait.max(wait);
        }
        body
    }

    fn take_names(&mut self, value: &Value) {
        for field in ["type", "code", "status", "reason", "quotaId"] {
            if let Some(name) = value[field].as_str() {
                self.names.push(name.to_lowercase());
            }
        }
    }

    /// Returns whether the body contains one of the parts, which are lower case.
    pub(in crate::remote) fn says(&self, parts: &[&str]) -> bool {
        parts.iter().any(|part| self.text.contains(part))
    }

    /// Returns the message, or else an identifier.
    pub(in crate::remote) fn words(&self) -> String {
        match (self.message.is_empty(), self.names.first()) {
            (false, _) => self.message.clone(),
            (true, Some(name)) => format!("an error named `{}`", shown(name, MAX_NAME)),
            (true, None) => "an error without a message".to_owned(),
        }
    }

    /// Returns the fault, if it is more specific than the HTTP status.
    pub(in crate::remote) fn fault(&self) -> Option<Fault> {
        let named = |part: &str| self.names.iter().any(|name| name.contains(part));
        let says = |part: &str| self.said.contains(part);
        let is_limit = named("rate_limit") || named("resource_exhausted");
        let is_spent = named("insufficient_quota")
            || named("billing")
            || named("perday")
            || says("credit balance")
            || says("insufficient credit");
        if is_spent {
            Some(Fault::QuotaExhausted)
        } else if named("perminute") || (is_limit && self.wait.is_some()) {
            Some(Fault::RateLimited)
        } else if named("resource_exhausted") && (says("quota") || says("billing")) {
            Some(Fault::QuotaExhausted)
        } else if is_limit {
            Some(Fault::RateLimited)
        } else if named("content_filter") || named("policy") || named("moderation") {
            Some(Fault::ContentFiltered)
        } else if named("api_key_invalid")
            || named("invalid_api_key")
            || named("authentication_error")
            // LiteLLM's proxy looks a key that is not its master key up in its database.
            || named("no_db_connection")
        {
            Some(Fault::NotAuthorised)
        } else if named("overloaded") || named("server_error") || named("api_error") {
            Some(Fault::ServerFailed)
        } else if named("timeout_error") || named("deadline_exceeded") {
            Some(Fault::TimedOut)
        } else if named("invalid_") || named("not_found") {
            Some(Fault::BadRequest)
        } else {
            None
        }
    }

    /// Makes the failure of a reply with status 200 that contains an error.
    pub(super) fn failure(&self, usage: Option<Usage>) -> Failure {
        let by_code = || match self.code? {
            401 | 403 => Some(Fault::NotAuthorised),
            402 => Some(Fault::QuotaExhausted),
            408 | 504 => Some(Fault::TimedOut),
            429 => Some(Fault::RateLimited),
            400..=499 => Some(Fault::BadRequest),
            _ => None,
        };
        let fault = self.fault().or_else(by_code);
        Failure::new(fault.unwrap_or(Fault::ServerFailed), self.words(), usage)
    }
}

/// Fails if `error` in a reply with status 200 says that something went wrong.
///
/// Some servers send an empty one beside an answer.
pub(super) fn refuse_error(error: Option<&Value>, usage: Option<Usage>) -> Result<(), Failure> {
    let is_stated = |error: &&Value| match error {
        Value::Null | Value::Bool(false) => false,
        Value::String(text) => !text.is_empty(),
        Value::Array(items) => !items.is_empty(),
        Value::Object(fields) => !fields.is_empty(),
        Value::Bool(true) | Value::Number(_) => true,
    };
    match error.filter(is_stated) {
        Some(error) => Err(ErrorBody::of(error).failure(usage)),
        None => Ok(()),
    }
}

/// Returns a provider's words as they are repeated: on one line, and not at any length.
pub(super) fn repeated(words: &str) -> String {
    shown(&joined(words), MAX_MESSAGE)
}

fn joined(words: &str) -> String {
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn code(value: &Value) -> Option<u16> {
    match value {
        Value::Number(number) => number.as_u64()?.try_into().ok(),
        Value::String(text) => text.parse().ok(),
        _ => None,
    }
}
