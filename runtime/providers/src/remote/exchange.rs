//! A call that failed: what was sent, and what came back.
//!
//! In: the fixed part of a model's calls, and a reply or the reason why there is none. Out: the parts from which `causes`
//! finds the reason and `message` makes its text.

use super::served::Served;
use super::settings::{Parameter, Settings};
use super::transport::{Incoming, NoReply, Obstacle};
use super::wire::error::ErrorBody;
use fab_base::wording::shown;
use fab_model::calls::Fault;
use reqwest::Url;
use serde_json::Value;

/// How much is shown before the place of a fault, bytes.
const MAX_PLACE: usize = 40;

/// What all calls of a model have in common.
pub(super) struct Sent {
    pub settings: Settings,
    pub url: Url,
    /// The variable that names the proxy in use.
    pub proxy: Option<String>,
}

/// A failed call.
pub(super) struct Exchange<'a> {
    pub sent: &'a Sent,
    pub came: &'a Came,
    pub fault: Fault,
    /// The models that the server lists, if it was asked.
    pub served: Option<&'a Served>,
    /// The parameter that the provider refuses and that can be left out.
    pub omit: Option<Parameter>,
}

/// What came instead of an answer.
pub(super) enum Came {
    /// A reply.
    Reply(Box<Received>),
    /// Nothing.
    Nothing(NoReply),
}

/// A reply that is not an answer.
pub(super) struct Received {
    pub incoming: Incoming,
    pub error: ErrorBody,
    pub body: Body,
    /// What a reader of the wire format found wrong with a reply of status 200.
    pub problem: Option<String>,
}

/// The form of a body.
pub(super) enum Body {
    Empty,
    Json(Value),
    /// JSON that ends too early.
    CutJson,
    /// A JSON object with another one behind it.
    SeveralJson,
    /// It begins as JSON does, and breaks its rules: what stands before that place.
    BrokenJson(String),
    Other,
}

impl Came {
    pub(super) fn reply(incoming: Incoming, problem: Option<String>) -> Came {
        Came::Reply(Box::new(Received {
            error: ErrorBody::of_bytes(&incoming.body),
            body: Body::of(&incoming.body),
            incoming,
            problem,
        }))
    }
}

impl Body {
    fn of(bytes: &[u8]) -> Body {
        if bytes.trim_ascii().is_empty() {
            return Body::Empty;
        }
        match serde_json::from_slice(bytes) {
            Ok(value) => Body::Json(value),
            Err(error) if error.is_eof() => Body::CutJson,
            Err(broken) => {
                let mut values = serde_json::Deserializer::from_slice(bytes).into_iter::<Value>();
                let is_object = |value: &Value| value.is_object();
                match (values.next(), values.next()) {
                    (Some(Ok(one)), Some(Ok(two))) if is_object(&one) && is_object(&two) => {
                        Body::SeveralJson
                    }
                    (Some(Ok(one)), Some(Err(error))) if is_object(&one) && error.is_eof() => {
                        Body::SeveralJson
                    }
                    _ if matches!(bytes.trim_ascii_start().first(), Some(b'{' | b'[')) => {
                        Body::BrokenJson(before(bytes, broken.line(), broken.column()))
                    }
                    _ => Body::Other,
                }
            }
        }
    }
}

/// Returns the end of what was read when a fault was found; line and column count from 1.
fn before(bytes: &[u8], line: usize, column: usize) -> String {
    let mut lines = bytes.split(|byte| *byte == b'\n');
    let read = lines.nth(line.saturating_sub(1)).unwrap_or_default();
    let read = &read[..column.min(read.len())];
    let end = &read[read.len().saturating_sub(MAX_PLACE)..];
    shown(&String::from_utf8_lossy(end), MAX_PLACE)
}

impl Exchange<'_> {
    /// Returns what prevented a reply.
    pub(super) fn obstacle(&self) -> Option<Obstacle> {
        match self.came {
            Came::Nothing(nothing) => Some(nothing.obstacle),
            Came::Reply(_) => None,
        }
    }

    /// Returns the reply.
    pub(super) fn received(&self) -> Option<&Received> {
        match self.came {
            Came::Reply(received) => Some(received),
            Came::Nothing(_) => None,
        }
    }

    /// Returns the status of the reply.
    pub(super) fn status(&self) -> Option<u16> {
        Some(self.received()?.incoming.status)
    }

    /// Returns the form of the reply's body.
    pub(super) fn body(&self) -> Option<&Body> {
        Some(&self.received()?.body)
    }

    /// Returns whether the reply contains one of the parts, which are lower case.
    pub(super) fn says(&self, parts: &[&str]) -> bool {
        let received = self.received();
        received.is_some_and(|received| received.error.says(parts))
    }

    /// Returns what a reader of the wire format found wrong.
    pub(super) fn problem(&self) -> Option<&str> {
        self.received()?.problem.as_deref()
    }

    /// Returns the parameter that the reply objects to.
    pub(super) fn parameter(&self) -> Option<&str> {
        self.received()?.error.parameter.as_deref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_are_told_apart() {
        for (body, expected) in [
            (" \n", "empty"),
            ("{}", "json"),
            ("{\"a\": [1", "cut"),
            ("{\"a\": 1}\n{\"a\": 2}\n", "several"),
            ("{\"a\": 1}\n{\"a\": 2}\n{\"a", "several"),
            ("{\"a\": 1}\n{\"a", "several"),
            ("{\"a\": 1}garbage", "broken"),
            ("{\"a\": NaN}", "broken"),
            (" [1, 2,, 3]", "broken"),
            ("<html>", "other"),
            ("12 monkeys", "other"),
        ] {
            let found = match Body::of(body.as_bytes()) {
                Body::Empty => "empty",
                Body::Json(_) => "json",
                Body::CutJson => "cut",
                Body::SeveralJson => "several",
                Body::BrokenJson(_) => "broken",
                Body::Other => "other",
            };
            assert_eq!(found, expected, "{body}");
        }
    }
}
