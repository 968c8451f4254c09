//! The likely causes of failed calls, with their remedies.
//!
//! In: a failed [`Exchange`]. Out: its likely cause and what to do. Each cause that people meet is a row of [`CAUSES`]; the
//! first one that applies is the likely one, so rows go from the specific to the general. Method, address, status and the
//! beginning of the body are in every message, so a failure without a row needs none.

use super::Key;
use super::exchange::Exchange;
use super::settings::Settings;
use super::transport::Obstacle;
use crate::catalogue::Wire;
use fab_base::wording::{quoted, shown};
use fab_model::calls::Fault;
use reqwest::Url;

/// The longest address of a redirect that is shown, characters.
const MAX_LOCATION: usize = 200;

/// A cause that a failed call may have. Texts name values as `{address}`; [`filled`] lists them.
struct Cause {
    /// Whether it is likely.
    applies: fn(&Exchange<'_>) -> bool,
    /// What is wrong.
    cause: &'static str,
    /// What to do.
    help: &'static str,
}

/// Every cause, the specific ones first.
const CAUSES: &[Cause] = &[
    // No connection, or no reply.
    Cause {
        applies: |e| e.is(Obstacle::Refused) && e.settings.base_url.is_loopback(),
        cause: "no server listens at `{address}`",
        help: "{start}, or give the address of a running one with `--base-url URL`",
    },
    Cause {
        applies: |e| {
            let is_proxy = e.status() == Some(407);
            e.is(Obstacle::Refused) || e.is(Obstacle::Unconnected) || is_proxy
        },
        cause: "no server can be reached at `{address}` from this machine",
        help: "check host and port in the base URL {base}, the connection, the proxy if `HTTPS_PROXY` or `HTTP_PROXY` names one, and that the server listens on more than its own 127.0.0.1 (often `--host 0.0.0.0`)",
    },
    Cause {
        applies: |e| e.is(Obstacle::Certificate),
        cause: "the certificate is self-signed, of an authority that this machine does not know, for another name, or not valid today",
        help: "name a PEM file with the authority's certificate in the variable `SSL_CERT_FILE`; check the clock with `date`",
    },
    Cause {
        applies: |e| e.is(Obstacle::Tls) || e.is(Obstacle::NoHttp),
        cause: "the base URL has `http://` where the server at `{address}` expects `https://` or the reverse, or another service listens there",
        help: "check the port in the base URL {base}, and whether it has to begin with `http://` or `https://`; a key is sent over plain http only to this machine",
    },
    Cause {
        applies: |e| e.is(Obstacle::Timeout),
        cause: "the model is slow, its queue is long, or the server is stuck: {limit} s is the limit of one call",
        help: "allow more with `--timeout SECONDS`, and look into the server's log",
    },
    // The address, the key and the model.
    Cause {
        applies: |e| location(e).is_some(),
        cause: "the server redirects to `{location}`, and a key is not sent after a redirect",
        help: "give the base of that address with `--base-url URL`, if you trust it",
    },
    Cause {
        applies: |e| e.failed.fault == Fault::NotAuthorised && e.settings.key.is_none(),
        cause: "no key was sent, since {no_key}",
        help: "set it in the environment or the file of keys, `export {name}=…`; a file of facts (`--models FILE`) may name it otherwise, `key_env = [\"NAME\"]`",
    },
    Cause {
        applies: |e| e.failed.fault == Fault::NotAuthorised,
        cause: "the server at `{address}` does not accept the key from `{key}`",
        help: "check that its value is whole, still valid, made for this server (a LiteLLM proxy without a database takes its master key alone), and allowed for this model; looked for: {keys}",
    },
    Cause {
        applies: names_no_model,
        cause: "the server does not serve `{model}`",
        help: "ask one that it serves, `--model {provider}:NAME`, or load the model in it; `fabc doctor` lists what servers on this machine serve, `fabc models {provider}` what is known of others",
    },
    Cause {
        applies: |e| matches!(e.status(), Some(404 | 405)),
        cause: "the server has no `{path}`: its interface lies elsewhere, or is not {interface}",
        help: "check the base URL {base}, or choose the provider whose interface the server speaks (`fabc models --help`; `openai-chat` for Chat Completions)",
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
            ])
        },
        cause: "the model `{model}` takes no pictures as it is served, or not so many",
        help: "serve a vision model (llama.cpp needs its projector too, `--mmproj FILE`), raise the limit (vLLM: `--limit-mm-per-prompt`), or ask another one: `--model vision=MODEL`",
    },
    Cause {
        applies: |e| e.status() == Some(413) || e.says(&["context length", "context size"]),
        cause: "question and answer are longer than the model's context, or than a gateway lets through",
        help: "raise the context of the server (llama.cpp `--ctx-size`, vLLM `--max-model-len`, Ollama `OLLAMA_CONTEXT_LENGTH`), or state fewer `tokens`; of a gateway, the size of a body (nginx: `client_max_body_size`)",
    },
    Cause {
        applies: |e| e.failed.is_refusal(),
        cause: "the server does not accept the question or a setting as it was sent",
        help: "`--omit SETTING` leaves out one that the reply names: temperature, top_p, tokens, reasoning or schema; `fabc models {provider}` shows what is known of the model",
    },
    // The server, and replies of status 200 that are no answers.
    Cause {
        applies: |e| {
            let faults = [Fault::ServerFailed, Fault::ConnectionCut, Fault::TimedOut];
            faults.contains(&e.failed.fault) && !e.is(Obstacle::Interrupted)
        },
        cause: "the server is overloaded, still loading its model, out of memory, or down behind a gateway",
        help: "fabc asks again by itself; if that does not suffice, the log of the server at `{address}` says why",
    },
    Cause {
        applies: is_empty,
        cause: "all of the model's text went into its reasoning, or it ended at once",
        help: "let the server leave it in the answer (llama.cpp: `--reasoning-format none`, or `--reasoning-budget 0` for no thoughts; vLLM: another `--reasoning-parser`, or none), ask with `--reasoning none`, or allow more `tokens`",
    },
    Cause {
        applies: |e| has_problem(e, "the reply ") || has_problem(e, "the answer is empty"),
        cause: "the reply is not in the form of {interface}; it may come from another interface, a streaming server, a login page or a proxy",
        help: "check the base URL {base}, choose the provider whose interface the server speaks (`fabc models --help`), or look into the log of the server",
    },
];

/// Returns the likely cause and its remedy, or nothing where the headline says it all.
pub(super) fn likely(exchange: &Exchange<'_>) -> Option<(String, String)> {
    let row = CAUSES.iter().find(|row| (row.applies)(exchange))?;
    let filled = |text| filled(text, exchange);
    Some((filled(row.cause), filled(row.help)))
}

/// Puts the values of a call into a text.
fn filled(text: &str, e: &Exchange<'_>) -> String {
    let Settings { profile, key, .. } = e.settings;
    let provider = &profile.provider;
    let names = &provider.key_env;
    let name = names.first().map_or("NAME", String::as_str);
    let no_key = match &names[..] {
        [] => "this provider has no name for one".to_owned(),
        [one] => format!("`{one}` is not set"),
        _ => format!("none of {} is set", quoted(names)),
    };
    let start = provider.start.as_ref();
    let start = start.map(|start| format!("start it with `{start}`"));
    let values = [
        ("{address}", authority(e)),
        ("{base}", format!("`{}`", e.settings.base_url)),
        ("{interface}", interface(provider.wire).to_owned()),
        ("{key}", key.as_ref().map_or("", Key::name).to_owned()),
        ("{keys}", quoted(names)),
        (
            "{limit}",
            format!("{:.1}", e.settings.timeout.as_secs_f64()),
        ),
        ("{location}", location(e).unwrap_or_default()),
        ("{model}", profile.id.clone()),
        ("{name}", name.to_owned()),
        ("{no_key}", no_key),
        ("{path}", e.url.path().to_owned()),
        ("{provider}", provider.name.clone()),
        ("{start}", start.unwrap_or("start the server".to_owned())),
    ];
    let fill = |text: String, (name, value): &(&str, String)| text.replace(name, value);
    values.iter().fold(text.to_owned(), fill)
}

fn authority(e: &Exchange<'_>) -> String {
    let host = e.url.host_str().unwrap_or_default();
    match e.url.port_or_known_default() {
        Some(port) => format!("{host}:{port}"),
        None => host.to_owned(),
    }
}

/// Returns whether the server says that it has no such model.
fn names_no_model(exchange: &Exchange<'_>) -> bool {
    let is_missing = [
        "not found",
        "not_found",
        "not exist",
        "invalid model",
        "not loaded",
    ];
    exchange.says(&["model"]) && exchange.says(&is_missing)
}

/// Returns whether a reply of the right form has no text.
fn is_empty(exchange: &Exchange<'_>) -> bool {
    let is_chat = exchange.settings.profile.provider.wire == Wire::OpenaiChat;
    let has_form = is_chat || !exchange.says(&["chat.completion"]);
    has_form && has_problem(exchange, "the answer is empty")
}

/// Returns whether what is wrong with a reply of status 200 begins so.
fn has_problem(exchange: &Exchange<'_>, beginning: &str) -> bool {
    let problem = exchange.failed.problem.as_ref();
    problem.is_some_and(|problem| problem.starts_with(beginning))
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
fn location(exchange: &Exchange<'_>) -> Option<String> {
    let incoming = exchange.failed.reply.as_ref().ok()?;
    let mut url: Url = exchange.url.join(incoming.location.as_ref()?).ok()?;
    if !(300..=399).contains(&incoming.status) {
        return None;
    }
    url.set_username("").ok()?;
    url.set_password(None).ok()?;
    url.set_query(None);
    url.set_fragment(None);
    Some(shown(url.as_str(), MAX_LOCATION))
}
