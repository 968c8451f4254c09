//! Asks a server which models it serves.
//!
//! In: a server's address, wire format and key. Out: the ids in the reply to `GET /models`, which every wire format has; or
//! why there are none. It asks no model and is not billed: one short reply, within a few seconds.

use super::transport::{Incoming, Obstacle, Proxy, Transport, TransportError};
use super::wire::error::ErrorBody;
use super::{Key, Redactor, Settings, headers, status};
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

/// What a server said about its models.
pub(super) type Served = Result<Vec<String>, NotListed>;

/// Why a server lists no models.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotListed {
    /// It wants a key, or another one.
    Unauthorised {
        /// The status.
        status: u16,
    },
    /// It answers with something else.
    Other(String),
    /// Nothing listens there.
    Absent,
    /// It does not answer.
    Unreachable(String),
}

/// Returns the ids of the models that a server says it serves, in its order.
///
/// Only the first page counts. `hidden`: further keys to hide.
pub fn served_models(
    settings: &Settings,
    hidden: &[Key],
    interrupt: &Interrupt,
) -> Result<Vec<String>, NotListed> {
    let redactor = Redactor::of(settings.key.iter().chain(hidden));
    let proxy = Proxy::to(&settings.base_url);
    let transport = Transport::new(redactor, settings.timeout, proxy);
    let transport = transport.map_err(NotListed::Unreachable)?;
    ask(settings, &transport, interrupt)
}

/// Asks through a transport that is there already.
pub(super) fn ask(settings: &Settings, transport: &Transport, interrupt: &Interrupt) -> Served {
    let url = settings.base_url.models(settings.wire);
    let version = settings.wire.version_header();
    let headers = headers(settings, version.as_slice());
    match transport.get(&url, &headers, (MAX_BYTES, TIMEOUT), interrupt) {
        Ok(incoming) => read(&incoming),
        Err(TransportError::Failed(nothing)) => Err(match nothing.obstacle {
            Obstacle::Refused => NotListed::Absent,
            _ => NotListed::Unreachable(nothing.words),
        }),
        Err(TransportError::Interrupted) => Err(NotListed::Unreachable("interrupted".to_owned())),
    }
}

fn read(incoming: &Incoming) -> Served {
    let status = incoming.status;
    if status != 200 {
        let refusal = status::judge(status, &ErrorBody::of_bytes(&incoming.body));
        return Err(match refusal.fault {
            Fault::NotAuthorised => NotListed::Unauthorised { status },
            _ => NotListed::Other(format!("HTTP {status}")),
        });
    }
    let list: Value = serde_json::from_slice(&incoming.body).unwrap_or_default();
    // Gemini calls the list `models`, and each id `models/ID`.
    let entries = ["data", "models"]
        .iter()
        .find_map(|name| list[name].as_array());
    // Ollama without a model has `null` there.
    if list["data"].is_null() && list["object"] == "list" {
        return Ok(Vec::new());
    }
    let Some(entries) = entries else {
        return Err(NotListed::Other("a reply that lists no models".to_owned()));
    };
    let ids = entries.iter().filter_map(|entry| {
        let id = entry["id"].as_str().or(entry["name"].as_str())?;
        Some(shown(id.strip_prefix("models/").unwrap_or(id), MAX_ID))
    });
    Ok(ids.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(status: u16, body: &str) -> Served {
        read(&Incoming {
            status,
            content_type: None,
            coding: None,
            location: None,
            wait: None,
            body: body.as_bytes().to_vec(),
        })
    }

    #[test]
    fn lists_of_all_interfaces_are_read() {
        let ids = |ids: &[&str]| Ok(ids.iter().map(|id| (*id).to_owned()).collect::<Vec<_>>());
        for (body, expected) in [
            (
                r#"{"object":"list","data":[{"id":"a"},{"id":"b"}]}"#,
                ids(&["a", "b"]),
            ),
            (
                r#"{"data":[{"type":"model","id":"claude"}],"has_more":false}"#,
                ids(&["claude"]),
            ),
            (
                r#"{"models":[{"name":"models/gemini-4"}]}"#,
                ids(&["gemini-4"]),
            ),
            (r#"{"object":"list","data":[]}"#, ids(&[])),
            (r#"{"object":"list","data":null}"#, ids(&[])),
            (r#"{"data":[{"id":"a\u001b[2J"}]}"#, ids(&["a\\u{1b}[2J"])),
            (r#"{"data":[{"id":7},{}]}"#, ids(&[])),
        ] {
            assert_eq!(listed(200, body), expected, "{body}");
        }
        for body in ["", "<html>", "[]", "{\"data\":3}"] {
            assert!(
                matches!(listed(200, body), Err(NotListed::Other(_))),
                "{body}"
            );
        }
        for status in [401, 403] {
            assert_eq!(listed(status, ""), Err(NotListed::Unauthorised { status }));
        }
        assert_eq!(
            listed(404, ""),
            Err(NotListed::Other("HTTP 404".to_owned()))
        );
    }
}
