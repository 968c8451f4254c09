//! A call that failed: what was sent, what came back, and both in words.
//!
//! In: a model's settings, and a reply or the reason why there is none. Out: a [`Message`] with method, URL, status, content
//! type, the beginning of the body, and the likely cause with its remedy, which [`causes`] knows.

use super::causes;
use super::served::Served;
use super::settings::{Parameter, Settings};
use super::transport::{Incoming, NoReply, Obstacle};
use super::wire::error::ErrorBody;
use fab_base::wording::shown;
use fab_model::calls::Fault;
use reqwest::{StatusCode, Url};

/// How much of a body is shown, characters.
const MAX_EXCERPT: usize = 200;

/// A failed call.
pub(super) struct Exchange<'a> {
    pub settings: &'a Settings,
    pub url: &'a Url,
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
    /// What a reader of the wire format found wrong with a reply of status 200.
    pub problem: Option<String>,
}

/// A failure in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    /// What happened, on one line.
    pub headline: String,
    /// The rest, a line each, which begins with a line break.
    pub details: String,
}

impl Came {
    pub(super) fn reply(incoming: Incoming, problem: Option<String>) -> Came {
        Came::Reply(Box::new(Received {
            error: ErrorBody::of_bytes(&incoming.body),
            incoming,
            problem,
        }))
    }
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

    /// Returns whether the reply contains one of the parts, which are lower case.
    pub(super) fn says(&self, parts: &[&str]) -> bool {
        let received = self.received();
        received.is_some_and(|received| received.error.says(parts))
    }

    /// Describes the failure.
    pub(super) fn message(&self) -> Message {
        let (headline, reply) = match self.came {
            Came::Reply(received) => (self.headline(received), described(&received.incoming)),
            Came::Nothing(nothing) => (
                words(nothing.obstacle).to_owned(),
                format!("none ({})", shown(&nothing.words, MAX_EXCERPT)),
            ),
        };
        let mut details = format!("\n  request: POST {}\n  reply: {reply}", self.url);
        if let Some((cause, help)) = causes::likely(self) {
            details.push_str(&format!("\n  likely cause: {cause}\n  help: {help}"));
        }
        Message { headline, details }
    }

    fn headline(&self, received: &Received) -> String {
        let Received { error, problem, .. } = received;
        let status = received.incoming.status;
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

/// Says what prevented a reply.
fn words(obstacle: Obstacle) -> &'static str {
    match obstacle {
        Obstacle::Refused => "the connection was refused",
        Obstacle::Unconnected => "no connection could be made",
        Obstacle::Certificate => "the server's certificate is not trusted",
        Obstacle::Tls => "no encrypted connection could be made",
        Obstacle::Timeout => "no complete reply came in time",
        Obstacle::NoHttp => "the reply is not HTTP",
        Obstacle::Cut => "the connection ended before the reply was complete",
        Obstacle::TooLong => "the reply is longer than the limit",
    }
}
