//! A call that failed: what was sent, what came back, and both in words.
//!
//! In: a model's settings, and a reply or the reason why there is none. Out: words, with method, URL, status, content
//! type, the beginning of the body, and the likely cause with its remedy, which [`causes`] knows.

use super::causes;
use super::settings::{Lengths, Settings};
use super::transport::{Incoming, NoReply, Obstacle};
use super::wire::error::ErrorBody;
use fab_base::wording::shown;
use fab_model::calls::{Billing, Fault, Usage};
use reqwest::{StatusCode, Url};
use std::time::Duration;

/// How much of a body is shown, characters.
const MAX_EXCERPT: usize = 200;

/// How requests and messages of providers name the schema, lower case.
const SCHEMA_NAMES: [&str; 4] = [
    "response_format",
    "responsejsonschema",
    "output_format",
    "schema",
];

/// A call without an answer.
pub(super) struct Failed {
    pub fault: Fault,
    pub billing: Billing,
    pub reply: Result<Incoming, NoReply>,
    /// What the reply says is wrong.
    pub error: ErrorBody,
    /// What a reader of the wire format found wrong with a reply of status 200.
    pub problem: Option<String>,
    pub usage: Option<Usage>,
    /// The lengths to ask with once more, if reasoning cut the answer off.
    pub again: Option<Lengths>,
}

/// A call that failed, and what is known about it.
pub(super) struct Exchange<'a> {
    pub settings: &'a Settings,
    pub url: &'a Url,
    pub failed: &'a Failed,
}

impl Failed {
    pub(super) fn of(fault: Fault, billing: Billing, reply: Result<Incoming, NoReply>) -> Failed {
        let body = reply.as_ref().map_or(&[][..], |incoming| &incoming.body);
        Failed {
            fault,
            billing,
            error: ErrorBody::of_bytes(body),
            reply,
            problem: None,
            usage: None,
            again: None,
        }
    }

    /// Returns whether the provider finds the request wrong, by a status that says no more.
    pub(super) fn is_refusal(&self) -> bool {
        let status = self.reply.as_ref().map(|incoming| incoming.status);
        self.fault == Fault::BadRequest && matches!(status, Ok(400 | 422))
    }

    /// Returns whether the provider refuses the schema of the answer.
    pub(super) fn refuses_schema(&self) -> bool {
        self.is_refusal() && self.error.says(&SCHEMA_NAMES)
    }

    /// Returns the wait that the provider asks for.
    pub(super) fn wait(&self) -> Option<Duration> {
        self.error.wait.max(self.reply.as_ref().ok()?.wait)
    }
}

impl Exchange<'_> {
    /// Returns whether this prevented a reply.
    pub(super) fn is(&self, obstacle: Obstacle) -> bool {
        matches!(&self.failed.reply, Err(nothing) if nothing.obstacle == obstacle)
    }

    /// Returns the status of the reply.
    pub(super) fn status(&self) -> Option<u16> {
        Some(self.failed.reply.as_ref().ok()?.status)
    }

    /// Returns whether the reply contains one of the parts, which are lower case.
    pub(super) fn says(&self, parts: &[&str]) -> bool {
        self.failed.error.says(parts)
    }

    /// Says what happened, on one line; and the rest, each line of which begins with a line break.
    pub(super) fn message(&self) -> [String; 2] {
        let (headline, reply) = match &self.failed.reply {
            Ok(incoming) => (self.headline(incoming.status), described(incoming)),
            Err(nothing) => (
                nothing.obstacle.words().to_owned(),
                format!("none ({})", shown(&nothing.words, MAX_EXCERPT)),
            ),
        };
        let mut details = format!("\n  request: POST {}\n  reply: {reply}", self.url);
        if let Some((cause, help)) = causes::likely(self) {
            details.push_str(&format!("\n  likely cause: {cause}\n  help: {help}"));
        }
        [headline, details]
    }

    fn headline(&self, status: u16) -> String {
        let Failed { error, problem, .. } = self.failed;
        let reason = StatusCode::from_u16(status).ok();
        let reason = reason.and_then(|status| status.canonical_reason());
        let reason = reason.unwrap_or_default();
        let status = format!("HTTP {status} {reason}");
        let status = status.trim_end();
        let repeats = |text: &str| text.is_empty() || text.eq_ignore_ascii_case(reason);
        match problem {
            Some(problem) if *problem == error.words() => {
                format!("{status} with an error in it: {problem}")
            }
            Some(problem) => format!("{status}, but {problem}"),
            None if repeats(&error.message) => status.to_owned(),
            None => format!("{status}: {}", error.message),
        }
    }
}

/// Returns content type, length and beginning of a reply.
fn described(incoming: &Incoming) -> String {
    let kind = incoming.content_type.as_deref();
    let kind = shown(kind.unwrap_or("no content type"), MAX_EXCERPT);
    let text = String::from_utf8_lossy(&incoming.body);
    match incoming.body.len() {
        0 => format!("{kind}, no body"),
        length => format!("{kind}, {length} bytes: `{}`", shown(&text, MAX_EXCERPT)),
    }
}
