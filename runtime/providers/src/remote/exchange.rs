//! A call that failed: what was sent, and what came back.
//!
//! In: the fixed part of a model's calls, and a reply or the reason why there is none. Out: the parts from which `causes`
//! finds the reason and `message` makes its text.

use super::served::Served;
use super::settings::{Parameter, Settings};
use super::transport::{Incoming, NoReply, Obstacle};
use super::wire::error::ErrorBody;
use fab_model::calls::Fault;
use reqwest::Url;
use serde_json::Value;

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
    /// The body, if it is JSON.
    pub json: Option<Value>,
    /// What a reader of the wire format found wrong with a reply of status 200.
    pub problem: Option<String>,
}

impl Came {
    pub(super) fn reply(incoming: Incoming, problem: Option<String>) -> Came {
        Came::Reply(Box::new(Received {
            error: ErrorBody::of_bytes(&incoming.body),
            json: serde_json::from_slice(&incoming.body).ok(),
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

    /// Returns what a reader of the wire format found wrong.
    pub(super) fn problem(&self) -> Option<&str> {
        self.received()?.problem.as_deref()
    }

    /// Returns the parameter that the reply objects to.
    pub(super) fn parameter(&self) -> Option<&str> {
        self.received()?.error.parameter.as_deref()
    }
}
