//! The likely causes of failed calls, with their remedies.
//!
//! In: a failed [`Exchange`]. Out: its likely cause and what to do. Each cause that people meet is a row of [`CAUSES`]; the
//! first one that applies is the likely one, so rows go from the specific to the general. Method, address, status and the
//! beginning of the body are in every message, so a failure without a row needs none.

use super::exchange::Exchange;
use super::transport::Obstacle;
use crate::catalogue::Wire;
use fab_base::wording::shown;
use fab_model::calls::Fault;
use reqwest::Url;

/// How many served models are listed.
const MAX_LISTED: usize = 12;

/// The longest address of a redirect that is shown, characters.
const MAX_LOCATION: usize = 200;

/// A cause that a failed call may have.
struct Cause {
    /// Whether it is likely.
    applies: fn(&Exchange<'_>) -> bool,
    /// What is wrong, and what to do.
    words: fn(&Exchange<'_>) -> (String, String),
}

/// Returns the likely cause and its remedy, or nothing where the headline says it all.
pub(super) fn likely(exchange: &Exchange<'_>) -> Option<(String, String)> {
    let row = CAUSES.iter().find(|row| (row.applies)(exchange))?;
    Some((row.words)(exchange))
}

/// Returns whether a list of the served models would tell what is wrong.
pub(super) fn asks_for_list(exchange: &Exchange<'_>) -> bool {
    exchange.status() == Some(404)
        || (exchange.fault == Fault::BadRequest && names_no_model(exchange))
}

/// Every cause, the specific ones first.
const CAUSES: &[Cause] = &[
    // No connection, or no reply.
    Cause {
        applies: |e| {
            let is_remote = !e.sent.settings.base_url.is_loopback();
            e.sent.proxy.is_some() && is_remote && (cannot_connect(e) || e.status() == Some(407))
        },
        words: |e| {
            let proxy = e.sent.proxy.as_deref().unwrap_or_default();
            (
                format!(
                    "`{proxy}` is set, so the call goes through that proxy, which does not pass it on"
                ),
                format!(
                    "check the value of `{proxy}`, `http://USER:PASSWORD@HOST:PORT` if it wants a login, or add `{}` to the variable `NO_PROXY`",
                    e.sent.url.host_str().unwrap_or_default()
                ),
            )
        },
    },
    Cause {
        applies: |e| {
            e.obstacle() == Some(Obstacle::Refused) && e.sent.settings.base_url.is_loopback()
        },
        words: |e| {
            let start = match &e.sent.settings.start {
                Some(start) => format!("start it with `{start}`"),
                None => "start the server".to_owned(),
            };
            (
                format!("no server listens at `{}`", authority(e)),
                format!("{start}, or give the address of a running one with `--base-url URL`"),
            )
        },
    },
    Cause {
        applies: cannot_connect,
        words: |e| {
            (
                format!(
                    "no server can be reached at `{}` from this machine",
                    authority(e)
                ),
                format!(
                    "check host and port in the base URL `{}`, the connection, and that the server listens on more than its own 127.0.0.1 (often `--host 0.0.0.0`)",
                    e.sent.settings.base_url
                ),
            )
        },
    },
    Cause {
        applies: |e| {
            let obstacle = e.obstacle();
            obstacle.is_some_and(|it| {
                matches!(
                    it,
                    Obstacle::UntrustedCertificate | Obstacle::ExpiredCertificate
                )
            })
        },
        words: |_| {
            (
                "the certificate is self-signed, of an authority that this machine does not know, or not valid today".to_owned(),
                "name a PEM file with the authority's certificate in the variable `SSL_CERT_FILE`; check the clock with `date`".to_owned(),
            )
        },
    },
    Cause {
        applies: |e| {
            let obstacle = e.obstacle();
            obstacle.is_some_and(|it| matches!(it, Obstacle::NoTls | Obstacle::NoHttp))
                || e.says(&["plain http request was sent to https port"])
        },
        words: |e| {
            (
                format!(
                    "the server at `{}` speaks plain http where https was meant, or the other way round, or is another service",
                    authority(e)
                ),
                format!(
                    "check the port in the base URL `{}`, and whether it has to begin with `http://` or `https://`; a key is sent over plain http only to this machine",
                    e.sent.settings.base_url
                ),
            )
        },
    },
    Cause {
        applies: |e| e.obstacle() == Some(Obstacle::Timeout),
        words: |e| {
            (
                format!(
                    "the model is slow, its queue is long, or the server is stuck: {:.1} s is the limit of one call",
                    e.sent.settings.timeout.as_secs_f64()
                ),
                "allow more with `--timeout SECONDS`, and look into the server's log".to_owned(),
            )
        },
    },
    // What a proxy, a gateway or another port answers.
    Cause {
        applies: |e| location(e).is_some(),
        words: |e| {
            let to = location(e).map_or(String::new(), |url| shown(url.as_str(), MAX_LOCATION));
            (
                format!("the server redirects to `{to}`, and a key is not sent after a redirect"),
                format!(
                    "give the final address, if you trust it: `--base-url {}`",
                    location_base(e).unwrap_or("URL".to_owned())
                ),
            )
        },
    },
    Cause {
        applies: |e| matches!(e.status(), Some(200 | 403)) && is_html(e),
        words: |e| {
            (
                "a web page came in place of an answer: of a login, a firewall, or a base URL that is not the interface's".to_owned(),
                format!("check the base URL {}, and open it in a browser from here", base_url(e)),
            )
        },
    },
    // Keys, credit and limits.
    Cause {
        applies: |e| e.fault == Fault::NotAuthorised && e.sent.settings.key.is_none(),
        words: |e| {
            let names = &e.sent.settings.key_names;
            let cause = match &names[..] {
                [] => "no key was sent, since this provider has no name for one".to_owned(),
                [one] => format!("no key was sent, since `{one}` is not set"),
                _ => format!("no key was sent, since none of {} is set", quoted(names)),
            };
            let help = match names.first() {
                Some(name) => {
                    format!("set it in the environment or the file of keys: `export {name}=…`")
                }
                None => {
                    "give the provider `key_env = [\"NAME\"]` in a file of facts (`--models FILE`)"
                        .to_owned()
                }
            };
            (cause, help)
        },
    },
    Cause {
        applies: |e| e.fault == Fault::NotAuthorised,
        words: |e| {
            let key = e.sent.settings.key.as_ref();
            let master = if e.says(&["no_db_connection"]) {
                "; a LiteLLM proxy without a database takes its master key alone"
            } else {
                ""
            };
            (
                format!(
                    "the server at `{}` does not accept the key from `{}`{master}",
                    authority(e),
                    key.map_or("", |key| key.name())
                ),
                format!(
                    "check that its value is whole, still valid, made for this server, and allowed for this model; looked for: {}",
                    quoted(&e.sent.settings.key_names)
                ),
            )
        },
    },
    Cause {
        applies: |e| e.fault == Fault::QuotaExhausted,
        words: |_| {
            (
                "the credit or the quota of the account is used up; waiting does not help"
                    .to_owned(),
                "add credit or raise the limit at the provider, or use the key of another account"
                    .to_owned(),
            )
        },
    },
    Cause {
        applies: |e| e.fault == Fault::RateLimited,
        words: |_| {
            (
                "too many calls or tokens in a short time; the account itself is in order".to_owned(),
                "fabc waits and asks again; if that does not suffice, run fewer rollouts at once (`bench --jobs 1`) or ask later".to_owned(),
            )
        },
    },
    // The model and the address.
    Cause {
        applies: |e| serves(e).is_some_and(|ids| !ids.contains(&e.sent.settings.model)),
        words: |e| match serves(e).unwrap_or_default() {
            [] => (
                "the server runs and serves no model yet".to_owned(),
                "load a model in the server, then ask again; `fabc doctor` lists what it serves"
                    .to_owned(),
            ),
            ids => (
                format!(
                    "the server does not serve `{}`; it serves {}",
                    e.sent.settings.model,
                    listed(ids)
                ),
                format!(
                    "write one of these: `--model {}:NAME`",
                    e.sent.settings.provider
                ),
            ),
        },
    },
    Cause {
        applies: |e| names_no_model(e) && serves(e).is_none() && !is_html(e),
        words: |e| {
            (
                format!("the server has no model `{}`", e.sent.settings.model),
                format!(
                    "`fabc doctor` lists what the servers on this machine serve; `fabc models {}` lists what is known of others",
                    e.sent.settings.provider
                ),
            )
        },
    },
    Cause {
        applies: |e| matches!(e.status(), Some(404 | 405)),
        words: |e| {
            let chat = if e.sent.settings.wire == Wire::OpenaiResponses {
                format!(
                    "; ask through Chat Completions: `--model openai-chat:{}`",
                    e.sent.settings.model
                )
            } else {
                String::new()
            };
            (
                format!(
                    "the server has no `{}`: its interface lies elsewhere, or is not {}",
                    e.sent.url.path(),
                    interface(e.sent.settings.wire)
                ),
                format!(
                    "check the base URL {}, or choose the provider whose interface the server speaks (`fabc models --help`){chat}",
                    base_url(e)
                ),
            )
        },
    },
    // The question.
    Cause {
        applies: |e| {
            e.says(&[
                "mmproj",
                "image(s) may be provided in one prompt",
                "image input is not supported",
                "not a multimodal model",
                "does not support image",
                "missing data required for image input",
            ])
        },
        words: |e| {
            (
                format!("the model `{}` takes no pictures as it is served, or not so many", e.sent.settings.model),
                "serve a vision model (llama.cpp needs its projector too, `--mmproj FILE`), raise the limit (vLLM: `--limit-mm-per-prompt`), or ask another one: `--model vision=MODEL`".to_owned(),
            )
        },
    },
    Cause {
        applies: |e| {
            e.status() == Some(413)
                || e.says(&[
                    "context length",
                    "context size",
                    "context window",
                    "context_length",
                ])
        },
        words: |_| {
            (
                "question and answer are longer than the model's context, or than a gateway lets through".to_owned(),
                "raise the context of the server (llama.cpp `--ctx-size`, vLLM `--max-model-len`, Ollama `OLLAMA_CONTEXT_LENGTH`), or state fewer `tokens`; of a gateway, the size of a body (nginx: `client_max_body_size`)".to_owned(),
            )
        },
    },
    Cause {
        applies: |e| e.omit.is_some(),
        words: |e| {
            let omit = e.omit.map_or("", |omit| omit.name());
            (
                format!("the server does not accept `{omit}` as it was sent"),
                format!(
                    "`--omit {omit}` leaves it out; `fabc models {}` shows what is known of the model",
                    e.sent.settings.provider
                ),
            )
        },
    },
    Cause {
        applies: |e| matches!(e.fault, Fault::ContentFiltered | Fault::Refused),
        words: |e| {
            (
                "the model declined, or a filter judged the question or the answer".to_owned(),
                format!(
                    "{}, change its words or its pictures, or ask another model",
                    look(e)
                ),
            )
        },
    },
    // The server.
    Cause {
        applies: |e| {
            matches!(e.status(), Some(408 | 502 | 503 | 504 | 524 | 529)) || e.says(&["overloaded"])
        },
        words: |e| {
            (
                "the server is overloaded, still loading its model, or down behind a gateway"
                    .to_owned(),
                format!(
                    "fabc asks again by itself; if that does not suffice, look whether the server behind `{}` runs, or ask later with `bench --jobs 1`",
                    authority(e)
                ),
            )
        },
    },
    Cause {
        applies: |e| matches!(e.fault, Fault::ServerFailed | Fault::ConnectionCut),
        words: |e| {
            let key = match (&e.sent.settings.key, e.sent.settings.key_names.first()) {
                (None, Some(name)) => format!("; no key was sent, so set `{name}` if it wants one"),
                _ => String::new(),
            };
            (
                "the server itself failed, or ran out of memory".to_owned(),
                format!("the log of the server at `{}` says why{key}", authority(e)),
            )
        },
    },
    // A reply of status 200 that is not an answer.
    Cause {
        applies: |e| {
            let problem = e.problem().unwrap_or_default();
            let is_empty =
                problem.contains("` holds: `") || problem.starts_with("the answer is empty");
            is_empty && other_interface(e).is_none()
        },
        words: |_| {
            (
                "all of the model's text went into its reasoning, or it ended at once".to_owned(),
                "let the server leave it in the answer (llama.cpp: `--reasoning-format none`, or `--reasoning-budget 0` for no thoughts; vLLM: another `--reasoning-parser`, or none), ask with `--reasoning none`, or allow more `tokens`".to_owned(),
            )
        },
    },
    Cause {
        applies: |e| e.fault == Fault::InvalidReply,
        words: |e| {
            let expected = interface(e.sent.settings.wire);
            let kind = e
                .received()
                .and_then(|it| it.incoming.content_type.as_deref());
            if kind.is_some_and(|kind| kind.contains("event-stream")) {
                return (
                    "the server streams its answer, though no stream was asked for".to_owned(),
                    "turn forced streaming off in the server or the gateway".to_owned(),
                );
            }
            let cause = match other_interface(e) {
                Some(other) => {
                    format!("the reply has the form of {other}, and {expected} was expected")
                }
                None => format!(
                    "the server does not quite speak {expected}, or a proxy answers in its place"
                ),
            };
            (
                cause,
                format!(
                    "choose the provider whose interface the server speaks (`fabc models --help`), check the base URL {}, or look into the log of the server",
                    base_url(e)
                ),
            )
        },
    },
    Cause {
        applies: |e| e.fault == Fault::BadRequest,
        words: |e| {
            (
                "the server understood the call and refuses it; the reply may say what it objects to".to_owned(),
                look(e),
            )
        },
    },
];

/// Returns how to see what was asked.
fn look(e: &Exchange<'_>) -> String {
    let settings = &e.sent.settings;
    format!(
        "look at the question with `fabc render FILE --model {}:{}`",
        settings.provider, settings.model
    )
}

fn authority(e: &Exchange<'_>) -> String {
    let url = &e.sent.url;
    let host = url.host_str().unwrap_or_default();
    match url.port_or_known_default() {
        Some(port) => format!("{host}:{port}"),
        None => host.to_owned(),
    }
}

/// Returns the base URL, with the usual one beside it if that is another.
fn base_url(e: &Exchange<'_>) -> String {
    let settings = &e.sent.settings;
    let (base, usual) = (
        settings.base_url.to_string(),
        settings.base_url.usual(settings.wire),
    );
    if base.trim_end_matches('/') == usual {
        format!("`{base}`")
    } else {
        format!("`{base}` (most servers have theirs at `{usual}`)")
    }
}

fn quoted(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

fn listed(ids: &[String]) -> String {
    let first = quoted(&ids[..ids.len().min(MAX_LISTED)]);
    match ids.len().saturating_sub(MAX_LISTED) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

fn cannot_connect(exchange: &Exchange<'_>) -> bool {
    use Obstacle::{ConnectTimeout, Refused, Unconnected, UnknownHost, Unrouted};
    let obstacle = exchange.obstacle();
    obstacle.is_some_and(|obstacle| {
        matches!(
            obstacle,
            ConnectTimeout | Refused | Unconnected | UnknownHost | Unrouted
        )
    })
}

fn is_html(exchange: &Exchange<'_>) -> bool {
    let Some(received) = exchange.received() else {
        return false;
    };
    let begins = |beginning: &[u8]| {
        let body = received.incoming.body.trim_ascii_start();
        let start = body.get(..beginning.len());
        start.is_some_and(|start| start.eq_ignore_ascii_case(beginning))
    };
    let kind = received
        .incoming
        .content_type
        .as_deref()
        .unwrap_or_default();
    let is_said = kind.to_lowercase().contains("text/html");
    begins(b"<!doctype html") || begins(b"<html") || (is_said && received.json.is_none())
}

/// Returns whether the server says that it has no such model.
fn names_no_model(exchange: &Exchange<'_>) -> bool {
    let is_missing = [
        "not found",
        "not_found",
        "does not exist",
        "not exist",
        "unknown",
        "invalid model",
        "no such",
        "no model",
        "not loaded",
    ];
    exchange.says(&["model"]) && exchange.says(&is_missing) || exchange.parameter() == Some("model")
}

/// Returns the models that the server listed.
fn serves<'e>(exchange: &'e Exchange<'_>) -> Option<&'e [String]> {
    exchange.served?.as_deref().ok()
}

/// Returns the interface whose answer a reply resembles, if it is another one than was asked.
fn other_interface(exchange: &Exchange<'_>) -> Option<&'static str> {
    let value = exchange.received()?.json.as_ref()?;
    let forms = [
        ("choices", interface(Wire::OpenaiChat)),
        ("output", interface(Wire::OpenaiResponses)),
        ("candidates", interface(Wire::Gemini)),
        ("stop_reason", interface(Wire::Anthropic)),
        ("data", "a list of models"),
        ("models", "a list of models"),
        ("message", "Ollama's own interface"),
        ("response", "Ollama's own interface"),
    ];
    let form = forms.iter().find(|(field, _)| value.get(field).is_some());
    let (_, form) = form?;
    (*form != interface(exchange.sent.settings.wire)).then_some(*form)
}

fn interface(wire: Wire) -> &'static str {
    match wire {
        Wire::OpenaiChat => "Chat Completions",
        Wire::OpenaiResponses => "Responses",
        Wire::Anthropic => "Anthropic's Messages",
        Wire::Gemini => "Gemini's generateContent",
    }
}

/// Returns where a redirect leads, without anything that may be secret.
fn location(exchange: &Exchange<'_>) -> Option<Url> {
    let incoming = &exchange.received()?.incoming;
    let location = incoming.location.as_ref()?;
    if !(300..=399).contains(&incoming.status) {
        return None;
    }
    let mut url = exchange.sent.url.join(location).ok()?;
    url.set_username("").ok()?;
    url.set_password(None).ok()?;
    url.set_query(None);
    url.set_fragment(None);
    Some(url)
}

/// Returns the base URL that would lead where a redirect leads.
fn location_base(exchange: &Exchange<'_>) -> Option<String> {
    let settings = &exchange.sent.settings;
    let whole = location(exchange)?.to_string();
    let end = format!("/{}", settings.wire.path(&settings.model).join("/"));
    let base = whole.trim_end_matches('/').strip_suffix(&end)?;
    Some(shown(base, MAX_LOCATION))
}

#[cfg(test)]
#[path = "tests/causes.rs"]
mod tests;
