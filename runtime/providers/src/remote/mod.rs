//! Provider models, called over HTTP.
//!
//! In: a [`Request`]. Out: a [`Reply`], bought once and cached, or a named fault. [`wire`] knows the providers' message
//! formats, `transport` sends one message, `exchange` and `causes` say why a call failed, `retry` decides what is tried
//! again, a [`Gate`] limits concurrency, `answers` caches paid answers. Every message is reported to [`Calls`] before it is
//! sent, and again when it ends. The maker of the [`Settings`] decides about facts and prices.

pub mod settings;
pub mod wire;

mod answers;
mod base_url;
mod causes;
mod exchange;
mod hidden;
mod hints;
mod key;
mod omit;
mod redact;
mod retry;
mod served;
mod status;
mod transport;

pub use super::catalogue::Wire;
pub use answers::Answers;
pub use base_url::{BaseUrl, BaseUrlError};
pub use key::{Key, KeyError};
pub use redact::Redactor;
pub use retry::{Pause, RealTime, Retry, most_calls};
pub use served::{NotListed, served_models};
pub use settings::{Lengths, Pricing, Settings};
/// Limits concurrent calls to one provider, over all rollouts.
pub use tokio::sync::Semaphore as Gate;

use answers::{Claim, Lookup};
use exchange::{Came, Exchange, Message};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Billing, Call, CallEnd, Calls, FailedCall, Fault, Usage, Usd};
use fab_model::{Lowering, Model, ModelError, ModelKind, Reply, Request};
use reqwest::Url;
use reqwest::header::{CONTENT_TYPE, HeaderMap, HeaderName, HeaderValue};
use retry::{Next, QuestionCalls};
use served::Served;
use settings::Parameter;
use std::borrow::Cow;
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;
use transport::{Incoming, Transport, TransportError};
use wire::error::ErrorBody;
use wire::{Answer, Encoded};

/// How often a waiting thread checks whether the user stopped it.
const INTERRUPT_POLL: Duration = Duration::from_millis(50);

/// A provider's model.
pub struct Remote {
    name: String,
    settings: Settings,
    url: Url,
    transport: Transport,
    shared: Shared,
    /// The models that the server lists, asked once, after the first failure that the list may explain.
    served: OnceLock<Served>,
    /// Whether the server has refused the schema of an answer; it gets none from then on.
    refuses_schema: AtomicBool,
}

/// The common parts of a run's models.
#[derive(Clone)]
pub struct Shared {
    /// Limits concurrent calls; one gate per provider.
    pub gate: Arc<Gate>,
    /// The cached answers.
    pub answers: Arc<Answers>,
    /// Ends waiting calls.
    pub interrupt: Interrupt,
    /// Told why a question waits for a retry.
    pub tell: MessageSink,
    /// Further keys to hide in replies, such as those of other providers.
    pub hidden: Vec<Key>,
}

/// Receives messages for the user while a question waits.
pub type MessageSink = Arc<dyn Fn(&str) + Send + Sync>;

/// Why nothing can be sent at all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot set up calls to `{model}`: {why}")]
pub struct SetupError {
    /// The model's name.
    pub model: String,
    /// The system's error.
    pub why: String,
}

/// A call without an answer.
struct FailedAttempt {
    fault: Fault,
    billing: Billing,
    came: Came,
    cost: Option<Usd>,
    usage: Option<Usage>,
    wait: Option<Duration>,
    /// The lengths to ask with once more, if hidden reasoning cut the answer off.
    again: Option<Lengths>,
    /// The parameter that the provider refuses.
    omit: Option<Parameter>,
}

impl FailedAttempt {
    fn of(fault: Fault, billing: Billing, came: Came) -> FailedAttempt {
        FailedAttempt {
            fault,
            billing,
            came,
            cost: None,
            usage: None,
            wait: None,
            again: None,
            omit: None,
        }
    }
}

impl Remote {
    /// Makes the model; its name is `PROVIDER:NAME`. Nothing is sent.
    ///
    /// Fails if the system's certificates or sockets are unavailable, or if
    /// the name or the base URL contains a key, because both are shown.
    pub fn new(settings: Settings, shared: Shared) -> Result<Remote, SetupError> {
        let redactor = Redactor::of(settings.key.iter().chain(&shared.hidden));
        let url = settings.base_url.endpoint(settings.wire, &settings.model);
        let named = format!("{}:{}", settings.provider, settings.model);
        let name = redactor.text(&named);
        if name != named || redactor.text(url.as_str()) != url.as_str() {
            return Err(SetupError {
                model: name,
                why: "its name or its base URL contains a key; leave it out".to_owned(),
            });
        }
        let transport = Transport::new(redactor, &settings);
        let transport = transport.map_err(|why| SetupError {
            model: name.clone(),
            why,
        })?;
        Ok(Remote {
            name,
            settings,
            url,
            transport,
            shared,
            served: OnceLock::new(),
            refuses_schema: AtomicBool::new(false),
        })
    }

    /// Returns the question as it would be sent.
    ///
    /// Fails if the model is known not to support something in the request.
    pub fn encoded(&self, request: &Request) -> Result<Encoded, ModelError> {
        self.encoded_within(request, self.lengths(request))
    }

    fn encoded_within(&self, request: &Request, lengths: Lengths) -> Result<Encoded, ModelError> {
        let wire = self.settings.wire;
        let encoded = wire.encode_within(request, &self.settings, lengths);
        encoded.map_err(|unfit| ModelError::Unsupported {
            model: self.name.clone(),
            why: unfit.0,
        })
    }

    /// Returns the longest answer that is asked for, visible and hidden.
    pub fn lengths(&self, request: &Request) -> Lengths {
        Lengths::of(request, &self.settings)
    }

    fn at_most(&self, request: &Request, lengths: Lengths) -> Option<Usd> {
        self.settings.pricing.at_most(&Request {
            max_tokens: lengths.sent(),
            ..request.clone()
        })
    }

    /// Asks until there is an answer or no further attempt.
    fn buy(
        &self,
        request: &Request,
        mut encoded: Encoded,
        claim: &Claim<'_>,
        calls: &mut dyn Calls,
    ) -> Result<Reply, ModelError> {
        let headers = headers(&self.settings, &encoded.headers);
        let key = request.key();
        let mut lengths = self.lengths(request);
        let mut at_most = self.at_most(request, lengths);
        let mut request = Cow::Borrowed(request);
        if self.refuses_schema.load(Ordering::Relaxed) {
            request.to_mut().schema = None;
            encoded = self.encoded_within(&request, lengths)?;
        }
        let retry = &self.settings.retry;
        let interrupt = &self.shared.interrupt;
        let mut tries = QuestionCalls::new(retry);
        loop {
            let pass = self.transport.wait(self.shared.gate.acquire(), interrupt);
            let pass = pass.ok_or(ModelError::Interrupted)?;
            calls.begin(&Call {
                model: &self.name,
                key: &key,
                number: tries.begin(),
                at_most,
            })?;
            let body = &encoded.body;
            let came = self.transport.post(&self.url, &headers, body, interrupt);
            let ended = match came {
                Ok(incoming) => match self.read(incoming, &encoded, lengths) {
                    Ok(answer) => {
                        claim.keep(&answer.text, answer.usage);
                        let reply = Reply {
                            cost: self.cost(answer.usage),
                            text: answer.text,
                            usage: answer.usage,
                        };
                        calls.end(&CallEnd::Answered(&reply))?;
                        return Ok(reply);
                    }
                    Err(ended) => ended,
                },
                Err(TransportError::Failed(nothing)) => {
                    let (fault, billing) = nothing.obstacle.fault();
                    FailedAttempt::of(fault, billing, Came::Nothing(nothing))
                }
                Err(TransportError::Interrupted) => {
                    calls.end(&CallEnd::Failed(&FailedCall {
                        fault: Fault::ConnectionCut,
                        why: "interrupted before the whole answer was there".to_owned(),
                        billing: Billing::Possibly,
                        cost: None,
                        usage: None,
                    }))?;
                    return Err(ModelError::Interrupted);
                }
            };
            drop(pass);
            let Message { headline, details } = self.message(&ended);
            calls.end(&CallEnd::Failed(&FailedCall {
                fault: ended.fault,
                why: format!("{headline}{details}"),
                billing: ended.billing,
                cost: ended.cost,
                usage: ended.usage,
            }))?;
            if ended.omit == Some(Parameter::Schema)
                && request.schema.is_some()
                && self.settings.structured_output.is_none()
            {
                if !self.refuses_schema.swap(true, Ordering::Relaxed) {
                    (self.shared.tell)(&format!(
                        "{}: the server refuses the schema of the answer ({headline}); it is asked without one from here on",
                        self.name
                    ));
                }
                request.to_mut().schema = None;
                encoded = self.encoded_within(&request, lengths)?;
                continue;
            }
            let next = match (ended.fault, ended.again) {
                // The same request would be cut off again.
                (Fault::Truncated, None) => tries.give_up(),
                (fault, _) => tries.after(fault, ended.wait),
            };
            match next {
                Next::After(wait) => {
                    if let Some(more) = ended.again {
                        lengths = more;
                        encoded = self.encoded_within(&request, lengths)?;
                        at_most = self.at_most(&request, lengths);
                    }
                    let seconds = wait.as_secs_f64();
                    (self.shared.tell)(&format!(
                        "{}: {}: {headline}; asked again in {seconds:.1} s",
                        self.name, ended.fault
                    ));
                    retry.pause.pause(wait, interrupt);
                }
                Next::GiveUp(tried) => {
                    return Err(ModelError::Failed {
                        model: self.name.clone(),
                        fault: ended.fault,
                        why: format!("{headline} ({tried}){details}"),
                    });
                }
            }
        }
    }

    /// Describes a failed call; the result holds no key.
    fn message(&self, ended: &FailedAttempt) -> Message {
        let mut exchange = Exchange {
            settings: &self.settings,
            url: &self.url,
            came: &ended.came,
            fault: ended.fault,
            served: None,
            omit: ended.omit,
        };
        if causes::asks_for_list(&exchange) {
            let ask = || served::ask(&self.settings, &self.transport, &self.shared.interrupt);
            exchange.served = Some(self.served.get_or_init(ask));
        }
        let message = exchange.message();
        // A key that the server split over two pieces of text is whole once they are joined.
        let redactor = self.transport.redactor();
        Message {
            headline: redactor.text(&message.headline),
            details: redactor.text(&message.details),
        }
    }

    /// Reads a reply; the answer holds no key.
    fn read(
        &self,
        incoming: Incoming,
        sent: &Encoded,
        lengths: Lengths,
    ) -> Result<Answer, FailedAttempt> {
        if !(200..300).contains(&incoming.status) {
            let refusal = status::judge(incoming.status, &ErrorBody::of_bytes(&incoming.body));
            let tokens_field = self.settings.reasoning.tokens_field.as_deref();
            let omit = match (refusal.fault, incoming.status) {
                (Fault::BadRequest, 400 | 422) => {
                    omit::refused(&incoming.body, &sent.body, tokens_field)
                }
                _ => None,
            };
            let wait = refusal.wait.max(incoming.wait);
            let came = Came::reply(incoming, None);
            return Err(FailedAttempt {
                wait,
                omit,
                ..FailedAttempt::of(refusal.fault, refusal.billing, came)
            });
        }
        match self.settings.wire.decode(&incoming.body) {
            Ok(answer) => Ok(Answer {
                text: self.transport.redactor().text(&answer.text),
                // A text has tokens: a count of zero is no report.
                usage: answer
                    .usage
                    .filter(|it| it.input_tokens > 0 && it.output_tokens > 0),
            }),
            Err(failure) => {
                let starved = hidden::starved(&failure, lengths);
                let again = starved.as_ref().and_then(|starved| starved.again);
                let usage = failure.usage.filter(|it| it.input_tokens > 0);
                let mut why = starved.map_or(failure.why, |starved| starved.why);
                if let Some(reasoning) = failure.reasoning {
                    why.push_str(&format!("; {reasoning}"));
                }
                let wait = incoming.wait;
                let came = Came::reply(incoming, Some(why));
                Err(FailedAttempt {
                    cost: self.cost(usage),
                    usage,
                    wait,
                    again,
                    ..FailedAttempt::of(failure.fault, Billing::Possibly, came)
                })
            }
        }
    }

    fn cost(&self, usage: Option<Usage>) -> Option<Usd> {
        self.settings.pricing.cost(usage?)
    }

    /// Hashes everything that an answer depends on. The request has what is not sent: its start, repetition, step and
    /// candidate.
    fn cache_key(&self, request: &Request, encoded: &Encoded) -> String {
        let mut parts = vec![
            "answer of a provider".to_owned(),
            self.settings.provider.clone(),
            self.url.to_string(),
            self.settings.model.clone(),
            request.key(),
        ];
        parts.extend(
            encoded
                .headers
                .iter()
                .map(|(name, value)| format!("{name}: {value}")),
        );
        Cache::key(
            parts
                .iter()
                .map(String::as_bytes)
                .chain([&encoded.body[..]]),
        )
    }
}

/// Returns the headers of a call: the key, and the wire format's own.
fn headers(settings: &Settings, own: &[(&'static str, &'static str)]) -> HeaderMap {
    let mut headers = HeaderMap::new();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static("application/json"));
    for (name, value) in own {
        headers.insert(
            HeaderName::from_static(name),
            HeaderValue::from_static(value),
        );
    }
    if let Some(key) = &settings.key {
        let (name, before) = settings.wire.key_header();
        let value = format!("{before}{}", key.expose());
        let mut value = HeaderValue::try_from(value).expect("a key is ASCII that can be seen");
        value.set_sensitive(true);
        headers.insert(HeaderName::from_static(name), value);
    }
    headers
}

impl Model for Remote {
    fn name(&self) -> &str {
        &self.name
    }

    fn nature(&self) -> ModelKind {
        ModelKind::Model
    }

    fn lowering(&self) -> Lowering {
        self.settings.lowering
    }

    fn omits(&self) -> Vec<&'static str> {
        let omitted = self.settings.omit.iter();
        omitted.map(|parameter| parameter.name()).collect()
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        let encoded = self.encoded(request)?;
        let key = self.cache_key(request, &encoded);
        match self.shared.answers.find(key, &self.shared.interrupt) {
            Lookup::Cached(kept) => Ok(Reply {
                text: kept.text,
                usage: kept.usage,
                cost: Some(Usd::ZERO),
            }),
            Lookup::Nothing(claim) => self.buy(request, encoded, &claim, calls),
            Lookup::Interrupted => Err(ModelError::Interrupted),
        }
    }
}

impl fmt::Debug for Remote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Remote")
            .field("name", &self.name)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}
