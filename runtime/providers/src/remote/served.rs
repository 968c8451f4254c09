//! Asks a server which models it serves.
//!
//! In: a server's address, wire format and key. Out: the ids in the reply to `GET /models`, which every wire format has; or
//! why there are none. It asks no model and is not billed: one short reply, within a few seconds.

use super::transport::{Incoming, Obstacle, Transport};
use super::wire::error::ErrorBody;
use super::{Redactor, Settings, headers, status};
use fab_base::interrupt::Interrupt;
use fab_base::wording::shown;
use fab_model::calls::Fault;
use serde_json::Value;
use std::time::Duration;

/// The longest list accepted, bytes; that of a gateway before many vendors has about 300 KB.
const MAX_BYTES: usize = 2 * 1024 * 1024;

/// Time limit of the whole exchange.
const TIMEOUT: Duration = Duration::from_secs(5);

/// The longest id that is repeated, characters.
const MAX_ID: usize = 100;

/// Why a server lists no models.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotListed {
    /// It wants a key, or another one.
    Unauthorised {
        /// The status.
        status: u16,
    },
    /// Nothing listens there.
    Absent,
    /// It does not answer, or with something else.
    Other(String),
}

/// Returns the ids of the models that a server says it serves, in its order.
///
/// Only the first page counts.
pub fn served_models(settings: &Settings, interrupt: &Interrupt) -> Result<Vec<String>, NotListed> {
    let redactor = Redactor::of(&settings.key);
    let transport = Transport::new(redactor, settings).map_err(NotListed::Other)?;
    let wire = settings.profile.provider.wire;
    let message = transport.client.get(settings.base_url.models(wire));
    let message = message.headers(headers(settings, wire.version_header().as_slice()));
    match transport.send(message.timeout(TIMEOUT), MAX_BYTES, interrupt) {
        Ok(incoming) => read(&incoming),
        Err(nothing) if nothing.obstacle == Obstacle::Refused => Err(NotListed::Absent),
        Err(nothing) => Err(NotListed::Other(nothing.words)),
    }
}

fn read(incoming: &Incoming) -> Result<Vec<String>, NotListed> {
    let status = incoming.status;
    if status != 200 {
        let (fault, _) = status::judge(status, &ErrorBody::of_bytes(&incoming.body));
        return Err(match fault {
            Fault::NotAuthorised => NotListed::Unauthorised { status },
            _ => NotListed::Other(format!("HTTP {status}")),
        });
    }
    let list: Value = serde_json::from_slice(&incoming.body).unwrap_or_default();
    // Gemini calls it `models`, and llama.cpp sends both. Ollama without a model has `null` there.
    let lists = [&list["data"], &list["models"]];
    let Some(entries) = lists.into_iter().find_map(Value::as_array) else {
        return match list["object"].as_str() {
            Some("list") => Ok(Vec::new()),
            _ => Err(NotListed::Other("a reply that lists no models".to_owned())),
        };
    };
    let ids = entries.iter().filter_map(|entry| {
        // Gemini's begin with `models/`.
        let id = entry["id"].as_str().or(entry["name"].as_str())?;
        Some(shown(id.strip_prefix("models/").unwrap_or(id), MAX_ID))
    });
    Ok(ids.collect())
}

#[cfg(test)]
#[path = "tests/served.rs"]
mod tests;
