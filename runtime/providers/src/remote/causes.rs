//! The likely causes of failed calls, with their remedies.
//!
//! In: a failed [`Exchange`]. Out: its likely cause and what to do. Each cause is a row of [`CAUSES`]: a test of the exchange,
//! and two sentences with fields such as `{host}`. The first row that applies is the likely cause, so rows go from the
//! specific to the general.

use super::exchange::{Body, Exchange, Sent};
use super::transport::{CONNECT_TIMEOUT, Obstacle};
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
    /// What is wrong.
    cause: &'static str,
    /// What to do.
    help: &'static str,
}

/// Returns the likely cause and its remedy, or nothing where the headline says it all.
pub(super) fn likely(exchange: &Exchange<'_>) -> Option<(String, String)> {
    let row = CAUSES.iter().find(|row| (row.applies)(exchange))?;
    Some((filled(row.cause, exchange), filled(row.help, exchange)))
}

/// Returns whether a list of the served models would tell what is wrong.
pub(super) fn asks_for_list(exchange: &Exchange<'_>) -> bool {
    exchange.status() == Some(404)
        || (exchange.fault == Fault::BadRequest && names_no_model(exchange))
}

/// Every cause, the specific ones first.
const CAUSES: &[Cause] = &[
    // No connection.
    Cause {
        applies: |e| {
            e.sent.proxy.is_some() && !e.sent.settings.base_url.is_loopback() && cannot_connect(e)
        },
        cause: "`{proxy}` is set, so the call goes through that proxy, and the proxy cannot be reached or does not pass it on",
        help: "check the value of `{proxy}`, or add `{host}` to the variable `NO_PROXY`",
    },
    Cause {
        applies: |e| {
            is(e, Obstacle::Refused)
                && e.sent.settings.base_url.is_loopback()
                && e.sent.settings.start.is_some()
        },
        cause: "no server listens at `{authority}`",
        help: "start it with `{start}`, or give the address of a running one with `--base-url URL`",
    },
    Cause {
        applies: |e| is(e, Obstacle::Refused) && e.sent.settings.base_url.is_loopback(),
        cause: "no server listens at `{authority}`",
        help: "start the server, or give the address of a running one with `--base-url URL`",
    },
    Cause {
        applies: |e| is(e, Obstacle::Refused),
        cause: "the machine `{host}` answers, and nothing listens at port {port}",
        help: "check the port in the base URL `{base_url}`; a server that listens only at 127.0.0.1 of its own machine needs an option such as `--host 0.0.0.0`",
    },
    Cause {
        applies: |e| is(e, Obstacle::UnknownHost),
        cause: "no machine is known by the name `{host}`, or this machine is not connected",
        help: "check the spelling of the base URL `{base_url}`, and the connection",
    },
    Cause {
        applies: |e| is(e, Obstacle::ConnectTimeout),
        cause: "`{authority}` did not accept the connection within {connect_timeout} s: the machine is off, the address is wrong, or a firewall drops the call",
        help: "check the base URL `{base_url}`, and that this machine may connect to it",
    },
    Cause {
        applies: |e| is(e, Obstacle::UntrustedCertificate),
        cause: "the certificate of `{host}` is self-signed, or signed by an authority that this machine does not trust",
        help: "add the authority's certificate to those of the system, or name a PEM file that holds it in the variable `SSL_CERT_FILE`",
    },
    Cause {
        applies: |e| is(e, Obstacle::ExpiredCertificate),
        cause: "the certificate of `{host}` has expired or is not valid yet, or the clock of this machine is wrong",
        help: "check the date here with `date`; if it is right, the certificate on the server has to be renewed",
    },
    Cause {
        applies: |e| is(e, Obstacle::NoTls),
        cause: "the server at `{authority}` speaks plain http, and the base URL says https",
        help: "write `http://` in the base URL; a key is sent over plain http only to this machine",
    },
    // A connection, and no reply.
    Cause {
        applies: |e| is(e, Obstacle::Timeout),
        cause: "the model is slow, its queue is long, or the server is stuck: {timeout} s is the limit of one call",
        help: "allow more with `--timeout SECONDS`, and look into the server's log",
    },
    Cause {
        applies: |e| is(e, Obstacle::NoHttp),
        cause: "what listens at `{authority}` is another service, or a server that expects https",
        help: "check the port in the base URL `{base_url}`, and whether it has to begin with `https://`",
    },
    Cause {
        applies: |e| is(e, Obstacle::BadHttp),
        cause: "the server at `{authority}`, or a proxy before it, sent a header or a length that is not valid",
        help: "look into its log; ask without the proxy, or with another version of the server",
    },
    Cause {
        applies: |e| is(e, Obstacle::Cut),
        cause: "the server, or a proxy before it, closed the connection; a server that runs out of memory does so",
        help: "look into the log of the server at `{authority}`",
    },
    // What a proxy, a gateway or another port answers.
    Cause {
        applies: |e| e.status() == Some(407) && e.sent.proxy.is_some(),
        cause: "the proxy named by `{proxy}` wants a user name and a password",
        help: "write them into its value, `http://USER:PASSWORD@HOST:PORT`, or add `{host}` to the variable `NO_PROXY`",
    },
    Cause {
        applies: |e| {
            e.says(&[
                "plain http request was sent to https port",
                "an http request to an https server",
            ])
        },
        cause: "the server at `{authority}` expects https",
        help: "write `https://` in the base URL",
    },
    Cause {
        applies: |e| in_range(e, 300, 399) && location(e).is_some(),
        cause: "the server redirects to `{location}`, and a key is not sent after a redirect",
        help: "give the final address: `--base-url {location_base}`, if you trust it",
    },
    Cause {
        applies: |e| in_range(e, 300, 399) && e.status() != Some(304),
        cause: "the base URL `{base_url}` leads elsewhere, and a key is not sent after a redirect",
        help: "give the final address with `--base-url URL`",
    },
    Cause {
        applies: |e| e.status() == Some(200) && is_html(e),
        cause: "a web page came in place of an answer: the login page of a proxy or a network, or a base URL that is not the interface's",
        help: "open `{base_url}` in a browser, and check the base URL{such_as_usual}",
    },
    Cause {
        applies: |e| in_range(e, 502, 504) && is_html(e),
        cause: "a gateway answers, and the server behind it does not",
        help: "look whether the server behind `{authority}` runs, and into the gateway's log",
    },
    Cause {
        applies: |e| e.status() == Some(403) && is_html(e),
        cause: "a gateway or a firewall refuses the call before it reaches the model",
        help: "open `{base_url}` in a browser from here: its page says who refuses; a VPN or a proxy may be the reason",
    },
    // Keys.
    Cause {
        applies: |e| is_unauthorised(e) && e.sent.settings.key.is_none(),
        cause: "no key was sent, since {key_names} set neither in the environment nor in the file of keys",
        help: "set `{key_name}` to a key that the server accepts: `export {key_name}=…`",
    },
    Cause {
        applies: |e| is_unauthorised(e) && e.says(&["no_db_connection"]),
        cause: "the key from `{key}` is not the master key of this LiteLLM proxy, which has no database of further keys",
        help: "set `{key_name}` to the value that `LITELLM_MASTER_KEY` had when the proxy was started; {looked_for}",
    },
    Cause {
        applies: |e| is_unauthorised(e) && e.says(&["model"]),
        cause: "the key from `{key}` may not be used for the model `{model}`",
        help: "ask a model that the key is for, or allow the key this one where it was made",
    },
    Cause {
        applies: |e| is_unauthorised(e) && e.status() == Some(403),
        cause: "the key from `{key}` is known and may not do this",
        help: "check its rights where it was made; {looked_for}",
    },
    Cause {
        applies: is_unauthorised,
        cause: "the server at `{authority}` does not accept the key from `{key}`",
        help: "check that its value is whole, still valid, and made for this server; {looked_for}",
    },
    // Money and limits.
    Cause {
        applies: |e| e.fault == Fault::QuotaExhausted,
        cause: "the credit or the quota of the account is used up; waiting does not help",
        help: "add credit or raise the limit at the provider, or use the key of another account",
    },
    Cause {
        applies: |e| e.fault == Fault::RateLimited,
        cause: "too many calls or tokens in a short time; the account itself is in order",
        help: "fabc waits and asks again; if that does not suffice, run fewer rollouts at once (`bench --jobs 1`) or ask later",
    },
    // The model.
    Cause {
        applies: |e| serves(e).is_some_and(<[String]>::is_empty),
        cause: "the server runs and serves no model yet",
        help: "load a model in the server, then ask again; `fabc doctor` lists what it serves",
    },
    Cause {
        applies: |e| serves(e).is_some_and(|ids| !ids.contains(&e.sent.settings.model)),
        cause: "the server does not serve `{model}`; it serves {served}",
        help: "write one of these: `--model {provider}:NAME`",
    },
    Cause {
        applies: |e| serves(e).is_some() && e.sent.settings.wire == Wire::OpenaiResponses,
        cause: "the server serves `{model}`, and has no Responses interface",
        help: "ask through Chat Completions: `--model openai-chat:{model}`, or `compatible:{model}`",
    },
    Cause {
        applies: |e| serves(e).is_some() && names_no_model(e),
        cause: "the server lists `{model}`, and cannot use it for this interface",
        help: "look into the server's log: the model may still be loading, or may not be one for chat",
    },
    Cause {
        applies: |e| serves(e).is_some(),
        cause: "the base URL is right, since the server lists its models there, and it has no `{path}`",
        help: "choose the provider whose interface the server speaks (`fabc models --help`)",
    },
    Cause {
        applies: |e| names_no_model(e) && !is_html(e),
        cause: "the server has no model `{model}`",
        help: "`fabc doctor` lists what the servers on this machine serve; `fabc models {provider}` lists what is known of others",
    },
    Cause {
        applies: |e| matches!(e.status(), Some(404 | 405)) && such_as_usual(e).is_empty(),
        cause: "the server has no such path, and no list of models beside it: it is another service, or its interface lies elsewhere",
        help: "check the port in the base URL `{base_url}`, and what the server's documentation says of its OpenAI-compatible base URL",
    },
    Cause {
        applies: |e| matches!(e.status(), Some(404 | 405)),
        cause: "the server has no such path, and no list of models beside it, so the base URL `{base_url}` is probably wrong",
        help: "most servers have the interface below `{usual}`: `--base-url {usual}`",
    },
    // The question.
    Cause {
        applies: |e| {
            e.says(&["image(s) may be provided in one prompt"]) && !e.says(&["at most 0 image"])
        },
        cause: "the question has more pictures than the server allows",
        help: "raise its limit (vLLM: `--limit-mm-per-prompt`), or show fewer pictures in the stage",
    },
    Cause {
        applies: |e| {
            e.says(&[
                "mmproj",
                "image input is not supported",
                "not a multimodal model",
                "at most 0 image",
                "does not support image",
                "missing data required for image input",
            ])
        },
        cause: "the model `{model}` takes no pictures as it is served",
        help: "serve a vision model; llama.cpp needs its projector too (`--mmproj FILE`); or ask another one: `--model vision=MODEL`",
    },
    Cause {
        applies: |e| {
            e.says(&[
                "context length",
                "context size",
                "exceed_context_size",
                "context window",
                "context_length_exceeded",
            ])
        },
        cause: "question and answer are longer than the model's context",
        help: "raise the context of the server (llama.cpp `--ctx-size`, vLLM `--max-model-len`, Ollama `OLLAMA_CONTEXT_LENGTH`), or state fewer `tokens`",
    },
    Cause {
        applies: |e| e.status() == Some(413),
        cause: "the server, or a gateway before it, does not accept bodies of this size; pictures make up most of it",
        help: "raise the limit there (nginx: `client_max_body_size`)",
    },
    Cause {
        applies: |e| e.omit.is_some(),
        cause: "the server does not accept `{omit}` as it was sent",
        help: "`--omit {omit}` leaves it out; `fabc models {provider}` shows what is known of the model",
    },
    Cause {
        applies: |e| {
            e.fault == Fault::BadRequest && e.parameter().is_some_and(|name| name != "model")
        },
        cause: "the server does not accept `{parameter}` as it was sent",
        help: "`fabc models {provider}` shows what is known of the model",
    },
    Cause {
        applies: |e| e.fault == Fault::ContentFiltered,
        cause: "a filter of the provider judged the question or the answer",
        help: "look at the question with `fabc render FILE --model {provider}:{model}`, and change its words or its pictures",
    },
    // The server.
    Cause {
        applies: |e| e.status() == Some(503) && e.says(&["loading model"]),
        cause: "the server is still loading its model",
        help: "wait until its log says that it is ready; fabc asks a few times more by itself",
    },
    Cause {
        applies: |e| {
            e.fault == Fault::ServerFailed
                && e.says(&["out of memory", "outofmemory", "more system memory"])
        },
        cause: "the server ran out of memory",
        help: "serve a smaller or a more quantised model, or with a shorter context",
    },
    Cause {
        applies: |e| matches!(e.status(), Some(503 | 529)) || e.says(&["overloaded"]),
        cause: "the server is overloaded, or down for a moment",
        help: "fabc asks again by itself; if that does not suffice, ask later or with `bench --jobs 1`",
    },
    Cause {
        applies: |e| matches!(e.status(), Some(408 | 502 | 504 | 524)),
        cause: "a gateway before the model waited in vain for it",
        help: "raise the gateway's time limit, or look whether the server behind it runs",
    },
    Cause {
        applies: |e| {
            e.status() == Some(500)
                && e.sent.settings.key.is_none()
                && !e.sent.settings.key_names.is_empty()
                && matches!(e.body(), Some(Body::Other))
        },
        cause: "the server itself failed; no key was sent, and LiteLLM's proxy without a database fails so if it wants one",
        help: "set `{key_name}` if the server wants a key; the log of the server at `{authority}` may say more",
    },
    Cause {
        applies: |e| e.fault == Fault::ServerFailed,
        cause: "the server itself failed",
        help: "the log of the server at `{authority}` says why",
    },
    // A reply of status 200 that is not an answer.
    Cause {
        applies: is_stream,
        cause: "the server streams its answer, though no stream was asked for",
        help: "turn forced streaming off in the server or the gateway",
    },
    Cause {
        applies: |e| is_success(e) && matches!(e.body(), Some(Body::Empty)),
        cause: "the server, or a proxy before it, sent a status and nothing else",
        help: "look into the log of the server at `{authority}`, and check the base URL `{base_url}`",
    },
    Cause {
        applies: |e| is_success(e) && matches!(e.body(), Some(Body::CutJson)),
        cause: "the JSON ends too early: the server crashed, or a proxy cuts long replies",
        help: "look into the log of the server at `{authority}`, and for a limit on reply size in the proxy",
    },
    Cause {
        applies: |e| is_success(e) && matches!(e.body(), Some(Body::SeveralJson)),
        cause: "several JSON values came in place of one: the server streams, as Ollama's own interface does",
        help: "use the server's OpenAI-compatible interface: `--base-url {usual}`",
    },
    Cause {
        applies: |e| is_success(e) && matches!(e.body(), Some(Body::BrokenJson(_))),
        cause: "the server, or a gateway before it, writes invalid JSON, such as a `NaN`, half of a character, or text after the end; it can be read up to `{place}`",
        help: "look into the log of the server at `{authority}`; another version of it may write correctly",
    },
    Cause {
        applies: |e| is_success(e) && matches!(e.body(), Some(Body::Other)),
        cause: "what answers at `{authority}` does not serve models, or a proxy answers in its place",
        help: "open `{base_url}` in a browser, and check the base URL{such_as_usual}",
    },
    Cause {
        applies: |e| e.fault == Fault::InvalidReply && other_interface(e).is_some(),
        cause: "the reply has the form of {other_interface}, and {interface} was expected",
        help: "choose the provider whose interface the server speaks (`fabc models --help`), or correct the base URL `{base_url}`",
    },
    Cause {
        applies: |e| e.fault == Fault::Refused,
        cause: "the model declined; the wording or a picture may be the reason",
        help: "look at the question with `fabc render FILE --model {provider}:{model}`, or ask another model",
    },
    Cause {
        applies: |e| {
            e.problem()
                .is_some_and(|problem| problem.contains("called a tool"))
        },
        cause: "the server offers tools of its own to the model",
        help: "turn its tools off in the server or the gateway",
    },
    Cause {
        applies: |e| {
            e.problem()
                .is_some_and(|problem| problem.contains("` holds: `"))
        },
        cause: "the server takes all that the model writes for reasoning, or the model has no tokens left after it",
        help: "let the server leave it in the answer (llama.cpp: `--reasoning-format none`, or `--reasoning-budget 0` for no thoughts; vLLM: another `--reasoning-parser`, or none), ask with `--reasoning none`, or allow more `tokens`",
    },
    Cause {
        applies: |e| {
            e.problem()
                .is_some_and(|problem| problem.starts_with("the answer is empty"))
        },
        cause: "the model ended at once, or all of its text went into reasoning that is not shown",
        help: "`fabc probe {provider}:{model}` asks a simple question; the log of the server at `{authority}` may say more",
    },
    Cause {
        applies: |e| e.fault == Fault::InvalidReply,
        cause: "the server does not quite speak {interface}",
        help: "look into the log of the server at `{authority}`; `fabc probe {provider}:{model}` asks a simple question",
    },
    Cause {
        applies: |e| e.fault == Fault::BadRequest && matches!(e.body(), Some(Body::Empty)),
        cause: "the server refuses the call and does not say why",
        help: "the log of the server at `{authority}` may say more",
    },
    Cause {
        applies: |e| e.fault == Fault::BadRequest,
        cause: "the server understood the call and refuses it; the reply says what it objects to",
        help: "look at the question with `fabc render FILE --model {provider}:{model}`",
    },
];

fn is(exchange: &Exchange<'_>, obstacle: Obstacle) -> bool {
    exchange.obstacle() == Some(obstacle)
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

fn in_range(exchange: &Exchange<'_>, from: u16, to: u16) -> bool {
    exchange
        .status()
        .is_some_and(|status| (from..=to).contains(&status))
}

fn is_success(exchange: &Exchange<'_>) -> bool {
    in_range(exchange, 200, 299)
}

fn is_unauthorised(exchange: &Exchange<'_>) -> bool {
    exchange.fault == Fault::NotAuthorised
}

fn starts(exchange: &Exchange<'_>, beginnings: &[&[u8]]) -> bool {
    let body = exchange
        .received()
        .map_or(&[][..], |came| &came.incoming.body);
    let body = body.trim_ascii_start();
    let starts = |beginning: &&[u8]| {
        let beginning_of_body = body.get(..beginning.len());
        beginning_of_body.is_some_and(|body| body.eq_ignore_ascii_case(beginning))
    };
    beginnings.iter().any(starts)
}

fn is_kind(exchange: &Exchange<'_>, part: &str) -> bool {
    let kind = exchange
        .received()
        .and_then(|came| came.incoming.content_type.as_ref());
    kind.is_some_and(|kind| kind.to_lowercase().contains(part))
}

fn is_html(exchange: &Exchange<'_>) -> bool {
    let is_json = matches!(exchange.body(), Some(Body::Json(_)));
    starts(exchange, &[b"<!doctype html", b"<html"]) || (is_kind(exchange, "text/html") && !is_json)
}

fn is_stream(exchange: &Exchange<'_>) -> bool {
    let is_json = matches!(exchange.body(), Some(Body::Json(_)));
    is_success(exchange)
        && !is_json
        && (is_kind(exchange, "text/event-stream")
            // The last begins a comment, which keeps a connection open.
            || starts(exchange, &[b"data:", b"event:", b": "]))
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
    let Some(Body::Json(value)) = exchange.body() else {
        return None;
    };
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

/// Returns the usual base URL as an example, unless it is the one in use.
fn such_as_usual(exchange: &Exchange<'_>) -> String {
    let settings = &exchange.sent.settings;
    let usual = settings.base_url.usual(settings.wire);
    let base = settings.base_url.to_string();
    let root = usual.trim_end_matches(settings.wire.version_segment());
    // A base without a path gets the usual version.
    match [usual.as_str(), root].contains(&base.as_str()) || base.trim_end_matches('/') == usual {
        true => String::new(),
        false => format!("; most servers have theirs at `{usual}`"),
    }
}

/// Fills in a sentence's fields.
fn filled(sentence: &str, exchange: &Exchange<'_>) -> String {
    let mut filled = String::new();
    let mut rest = sentence;
    while let Some((before, after)) = rest.split_once('{') {
        let (field, after) = after.split_once('}').unwrap_or((after, ""));
        filled.push_str(before);
        filled.push_str(&value(field, exchange));
        rest = after;
    }
    filled.push_str(rest);
    filled
}

/// Returns the value of a sentence's field.
fn value(field: &str, exchange: &Exchange<'_>) -> String {
    let Sent {
        settings,
        url,
        proxy,
    } = exchange.sent;
    let host = url.host_str().unwrap_or_default();
    let port = url.port_or_known_default();
    let port = port.map_or(String::new(), |port| port.to_string());
    let quoted = |names: &[String], between: &str| {
        let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        names.join(between)
    };
    match field {
        "host" => host.to_owned(),
        "port" => port,
        "authority" => format!("{host}:{port}"),
        "base_url" => settings.base_url.to_string(),
        "path" => url.path().to_owned(),
        "usual" => settings.base_url.usual(settings.wire),
        "such_as_usual" => such_as_usual(exchange),
        "provider" => settings.provider.clone(),
        "model" => settings.model.clone(),
        "interface" => interface(settings.wire).to_owned(),
        "other_interface" => other_interface(exchange).unwrap_or_default().to_owned(),
        "start" => settings.start.clone().unwrap_or_default(),
        "timeout" => format!("{:.1}", settings.timeout.as_secs_f64()),
        "connect_timeout" => CONNECT_TIMEOUT
            .min(settings.timeout)
            .as_secs_f64()
            .to_string(),
        "proxy" => proxy.clone().unwrap_or("HTTPS_PROXY".to_owned()),
        "key" => match &settings.key {
            Some(key) => key.name().to_owned(),
            None => String::new(),
        },
        "key_name" => settings
            .key_names
            .first()
            .cloned()
            .unwrap_or("NAME".to_owned()),
        "key_names" => match &settings.key_names[..] {
            [] => "this provider has no name for one, and it is".to_owned(),
            [one] => format!("`{one}` is"),
            names => format!("{} are", quoted(names, " and ")),
        },
        "looked_for" => match &settings.key_names[..] {
            [] | [_] => "it was the only name looked for".to_owned(),
            names => format!(
                "looked for: {}, and the first one that is set counts",
                quoted(names, ", ")
            ),
        },
        "parameter" => exchange.parameter().unwrap_or_default().to_owned(),
        "omit" => exchange.omit.map_or("", |omit| omit.name()).to_owned(),
        "served" => match serves(exchange).unwrap_or_default() {
            names if names.len() > MAX_LISTED => {
                let more = names.len() - MAX_LISTED;
                format!("{} and {more} more", quoted(&names[..MAX_LISTED], ", "))
            }
            names => quoted(names, ", "),
        },
        "place" => match exchange.body() {
            Some(Body::BrokenJson(before)) => before.clone(),
            _ => String::new(),
        },
        "location" => {
            location(exchange).map_or(String::new(), |url| shown(url.as_str(), MAX_LOCATION))
        }
        "location_base" => location_base(exchange).unwrap_or("URL".to_owned()),
        // A test reads every sentence.
        _ => format!("{{{field}}}"),
    }
}

/// Returns where a redirect leads, without anything that may be secret.
fn location(exchange: &Exchange<'_>) -> Option<Url> {
    let location = exchange.received()?.incoming.location.as_ref()?;
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
