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
mod redact;
mod retry;
mod served;
mod status;
mod transport;

pub use super::catalogue::Wire;
pub use answers::Answers;
pub use base_url::BaseUrl;
pub use key::Key;
pub use redact::Redactor;
pub use retry::{Retry, most_calls};
pub use served::{NotListed, served_models};
pub use settings::{Lengths, Settings};
/// Limits concurrent calls to one provider, over all rollouts.
pub use tokio::sync::Semaphore as Gate;

use crate::catalogue::Profile;
use exchange::{Exchange, Failed};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Billing, Call, CallRefused, Calls, FailedCall, Fault, Usage, Usd};
use fab_model::{Lowering, Model, ModelError, ModelKind, Reply, Request};
use reqwest::Url;
use reqwest::header::{CONTENT_TYPE, HeaderMap, HeaderName, HeaderValue};
use retry::QuestionCalls;
use std::borrow::Cow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use transport::{Incoming, NoReply, Transport};
use wire::error::ErrorBody;
use wire::{Answer, Encoded};

/// How often a waiting thread checks whether the user stopped it.
const INTERRUPT_POLL: Duration = Duration::from_millis(50);

/// The largest reply accepted, bytes.
const MAX_REPLY_BYTES: usize = 16 * 1024 * 1024;

/// A provider's model.
pub struct Remote {
    name: String,
    settings: Settings,
    url: Url,
    transport: Transport,
    shared: Shared,
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

impl Remote {
    /// Makes the model; its name is `PROVIDER:NAME`. Nothing is sent.
    ///
    /// Fails with the reason if the system's certificates or sockets are unavailable, or if
    /// the name or the base URL contains a key, because both are shown.
    pub fn new(settings: Settings, shared: Shared) -> Result<Remote, String> {
        let redactor = Redactor::of(settings.key.iter().chain(&shared.hidden));
        let profile = &settings.profile;
        let url = { &settings.base_url }.endpoint(profile.provider.wire, &profile.id);
        let named = profile.title();
        let name = redactor.text(&named);
        let failed = |why: &str| format!("cannot set up calls to `{name}`: {why}");
        if name != named || redactor.text(url.as_str()) != url.as_str() {
            return Err(failed(
                "its name or its base URL contains a key; leave it out",
            ));
        }
        let transport = Transport::new(redactor, &settings).map_err(|why| failed(&why))?;
        Ok(Remote {
            name,
            settings,
            url,
            transport,
            shared,
            refuses_schema: AtomicBool::new(false),
        })
    }

    /// Returns what is known of the model.
    pub fn profile(&self) -> &Profile {
        &self.settings.profile
    }

    /// Returns the question as it would be sent.
    ///
    /// Fails if the model is known not to support something in the request.
    pub fn encoded(&self, request: &Request) -> Result<Encoded, ModelError> {
        self.encoded_within(request, self.lengths(request))
    }

    fn encoded_within(&self, request: &Request, lengths: Lengths) -> Result<Encoded, ModelError> {
        let wire = self.settings.profile.provider.wire;
        let encoded = wire.encode(request, &self.settings, lengths);
        encoded.map_err(|why| ModelError::Unsupported {
            model: self.name.clone(),
            why,
        })
    }

    /// Returns the longest answer that is asked for, visible and hidden.
    pub fn lengths(&self, request: &Request) -> Lengths {
        Lengths::of(request, &self.settings)
    }

    /// Asks until there is an answer or no further attempt.
    fn buy(
        &self,
        request: &Request,
        mut encoded: Encoded,
        cached_as: &str,
        calls: &mut dyn Calls,
    ) -> Result<Reply, ModelError> {
        let Settings { profile, price, .. } = &self.settings;
        let headers = headers(&self.settings, &encoded.headers);
        let key = request.key();
        let mut lengths = self.lengths(request);
        let mut request = Cow::Borrowed(request);
        if self.refuses_schema.load(Ordering::Relaxed) {
            request.to_mut().schema = None;
            encoded = self.encoded_within(&request, lengths)?;
        }
        let interrupt = &self.shared.interrupt;
        let mut tries = QuestionCalls::new(&self.settings.retry);
        loop {
            let pass = self.transport.wait(self.shared.gate.acquire(), interrupt);
            let pass = pass.ok_or(CallRefused::Interrupted)?;
            calls.begin(&Call {
                model: &self.name,
                key: &key,
                number: tries.begin(),
                at_most: profile.at_most(*price, &request, lengths.sent()),
            })?;
            let message = self.transport.client.post(self.url.clone());
            let message = message.headers(headers.clone()).body(encoded.body.clone());
            let reply = self.transport.send(message, MAX_REPLY_BYTES, interrupt);
            let failed = match self.read(reply, lengths) {
                Ok(answer) => {
                    self.shared.answers.put(cached_as, &answer);
                    let reply = Reply {
                        cost: self.cost(answer.usage),
                        text: answer.text,
                        usage: answer.usage,
                    };
                    calls.end(Ok(&reply))?;
                    return Ok(reply);
                }
                Err(failed) => failed,
            };
            drop(pass);
            let [headline, details] = self.message(&failed);
            calls.end(Err(&FailedCall {
                fault: failed.fault,
                why: format!("{headline}{details}"),
                billing: failed.billing,
                cost: self.cost(failed.usage),
                usage: failed.usage,
            }))?;
            if interrupt.is_raised() {
                return Err(CallRefused::Interrupted.into());
            }
            if request.schema.is_some()
                && profile.facts.structured_output.is_none()
                && failed.refuses_schema()
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
            let wait = match (failed.fault, failed.again) {
                // The same request would be cut off again.
                (Fault::Truncated, None) => Err(tries.in_words()),
                (fault, _) => tries.after(fault, failed.wait()),
            };
            let wait = wait.map_err(|tried| ModelError::Failed {
                model: self.name.clone(),
                fault: failed.fault,
                why: format!("{headline} ({tried}){details}"),
            })?;
            if let Some(more) = failed.again {
                lengths = more;
                encoded = self.encoded_within(&request, lengths)?;
            }
            let seconds = wait.as_secs_f64();
            (self.shared.tell)(&format!(
                "{}: {}: {headline}; asked again in {seconds:.1} s",
                self.name, failed.fault
            ));
            let sleep = async { tokio::time::sleep(wait).await };
            self.transport.wait(sleep, interrupt);
        }
    }

    /// Describes a failed call, in a headline and details; they hold no key.
    fn message(&self, failed: &Failed) -> [String; 2] {
        let exchange = Exchange {
            settings: &self.settings,
            url: &self.url,
            failed,
        };
        // A key that the server split over two pieces of text is whole once they are joined.
        let redactor = &self.transport.redactor;
        exchange.message().map(|text| redactor.text(&text))
    }

    /// Reads a reply; the answer holds no key.
    fn read(
        &self,
        reply: Result<Incoming, NoReply>,
        lengths: Lengths,
    ) -> Result<Answer, Box<Failed>> {
        let incoming = reply.map_err(|nothing| {
            let (fault, billing) = nothing.obstacle.fault();
            Box::new(Failed::of(fault, billing, Err(nothing)))
        })?;
        let Settings { profile, .. } = &self.settings;
        if !(200..300).contains(&incoming.status) {
            let error = ErrorBody::of_bytes(&incoming.body);
            let (fault, billing) = status::judge(incoming.status, &error);
            return Err(Box::new(Failed::of(fault, billing, Ok(incoming))));
        }
        match profile.provider.wire.decode(&incoming.body) {
            Ok(answer) => Ok(Answer {
                text: self.transport.redactor.text(&answer.text),
                // A text has tokens: a count of zero is no report.
                usage: answer
                    .usage
                    .filter(|it| it.input_tokens > 0 && it.output_tokens > 0),
            }),
            Err(failure) => {
                let (mut why, mut again) = (failure.why, None);
                if let Some(text) = failure.cut_text {
                    let remedy = hidden::remedy(&text, failure.usage, lengths);
                    why.push_str(&format!("; {}", remedy.0));
                    again = remedy.1;
                }
                Err(Box::new(Failed {
                    problem: Some(why),
                    usage: failure.usage.filter(|it| it.input_tokens > 0),
                    again,
                    ..Failed::of(failure.fault, Billing::Possibly, Ok(incoming))
                }))
            }
        }
    }

    fn cost(&self, usage: Option<Usage>) -> Option<Usd> {
        Some(self.settings.price?.cost(usage?))
    }

    /// Hashes everything that an answer depends on. The request has what is not sent: its start, repetition, step and
    /// candidate.
    fn cache_key(&self, request: &Request, encoded: &Encoded) -> String {
        let profile = &self.settings.profile;
        let parts = [
            "answer of a provider".to_owned(),
            profile.provider.name.clone(),
            self.url.to_string(),
            profile.id.clone(),
            request.key(),
        ];
        let headers = encoded.headers.iter();
        let headers = headers.map(|(name, value)| format!("{name}: {value}"));
        let parts = parts.into_iter().chain(headers).map(String::into_bytes);
        Cache::key(parts.chain([encoded.body.clone()]))
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
        let (name, before) = settings.profile.provider.wire.key_header();
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
        let Shared {
            answers, interrupt, ..
        } = &self.shared;
        let lock = answers.lock(&key);
        let asking = self.transport.wait(lock.lock(), interrupt);
        let _asking = asking.ok_or(CallRefused::Interrupted)?;
        match answers.get(&key) {
            Some(kept) => Ok(Reply {
                text: kept.text,
                usage: kept.usage,
                cost: Some(Usd::ZERO),
            }),
            None => self.buy(request, encoded, &key, calls),
        }
    }
}
