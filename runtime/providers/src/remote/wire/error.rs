//! Parses providers' errors.
//!
//! In: the `error` of a reply, in any of the providers' formats, and the HTTP status if there is one. Out: a [`Fault`],
//! a message, and how long to wait if the provider says so.

use super::Failure;
use crate::remote::status::judge;
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

/// Parts of identifiers with their faults; the first row that applies counts.
const FAULTS: [(&[&str], Fault); 7] = [
    (
        &["insufficient_quota", "billing", "perday"],
        Fault::QuotaExhausted,
    ),
    (
        &["rate_limit", "resource_exhausted", "perminute"],
        Fault::RateLimited,
    ),
    (
        &["content_filter", "policy", "moderation"],
        Fault::ContentFiltered,
    ),
    (
        // LiteLLM's proxy looks a key that is not its master key up in its database.
        &[
            "api_key_invalid",
            "invalid_api_key",
            "authentication_error",
            "no_db_connection",
        ],
        Fault::NotAuthorised,
    ),
    (
        &["overloaded", "server_error", "api_error"],
        Fault::ServerFailed,
    ),
    (&["timeout_error", "deadline_exceeded"], Fault::TimedOut),
    (&["invalid_", "not_found"], Fault::BadRequest),
];

/// A provider's error.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::remote) struct ErrorBody {
    /// Its message on one line; empty if it has none, or is not JSON.
    pub(in crate::remote) message: String,
    /// The beginning of the body, lower case.
    text: String,
    /// All its identifiers: types, codes, reasons, quotas; lower case.
    names: Vec<String>,
    /// A numeric code, meant as an HTTP status.
    code: Option<u16>,
    /// The longest wait that it asks for.
    pub(in crate::remote) wait: Option<Duration>,
}

impl ErrorBody {
    /// Reads a whole body; if it is not JSON, only its text is searched.
    pub(in crate::remote) fn of_bytes(bytes: &[u8]) -> ErrorBody {
        let searched = &bytes[..bytes.len().min(MAX_SEARCHED)];
        let text = String::from_utf8_lossy(searched).to_lowercase();
        let value: Value = serde_json::from_slice(bytes).unwrap_or_default();
        let first = value.get(0).unwrap_or(&value);
        // FastAPI calls it `detail`, and lists what it finds wrong with a request.
        let error = first.get("error").or(first.get("detail"));
        let error = error.unwrap_or(first);
        ErrorBody {
            text,
            ..ErrorBody::of(error.get(0).unwrap_or(error))
        }
    }

    /// Reads the value of `error`.
    fn of(error: &Value) -> ErrorBody {
        let message = error["message"].as_str().or(error["msg"].as_str());
        let message = message.or(error.as_str()).unwrap_or_default();
        let mut body = ErrorBody {
            message: repeated(message),
            text: message.to_lowercase(),
            // A number, or a text with one.
            code: error["code"].to_string().trim_matches('"').parse().ok(),
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
            let name = value[field].as_str();
            self.names.extend(name.map(str::to_lowercase));
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
        let named = |parts: &[&str]| {
            let mut names = self.names.iter();
            names.any(|name| parts.iter().any(|part| name.contains(part)))
        };
        // Gemini has one name for both; what lasts has no time after which to ask again.
        let is_quota = named(&["resource_exhausted"])
            && self.wait.is_none()
            && !named(&["perminute"])
            && self.message.to_lowercase().contains("quota");
        if is_quota || self.says(&["credit balance", "insufficient credit"]) {
            return Some(Fault::QuotaExhausted);
        }
        let found = FAULTS.iter().find(|(parts, _)| named(parts));
        found.map(|(_, fault)| *fault)
    }

    /// Makes the failure of a reply with status 200 that contains an error.
    fn failure(&self, usage: Option<Usage>) -> Failure {
        let status = self.code.filter(|code| (400..=599).contains(code));
        let by_code = || status.map(|status| judge(status, self).0);
        let fault = self.fault().or_else(by_code);
        Failure::new(fault.unwrap_or(Fault::ServerFailed), self.words(), usage)
    }
}

/// Fails if `error` in a reply with status 200 says that something went wrong.
///
/// Some servers send an empty one beside an answer.
pub(super) fn refuse_error(error: &Value, usage: Option<Usage>) -> Result<(), Failure> {
    let empty = ["null", "false", "\"\"", "[]", "{}"];
    if empty.contains(&error.to_string().as_str()) {
        return Ok(());
    }
    Err(ErrorBody::of(error).failure(usage))
}

/// Returns a provider's words as they are repeated: on one line, and not at any length.
pub(super) fn repeated(words: &str) -> String {
    let joined = words.split_whitespace().collect::<Vec<_>>().join(" ");
    shown(&joined, MAX_MESSAGE)
}
