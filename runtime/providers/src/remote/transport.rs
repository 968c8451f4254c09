//! Sends one message and waits for the reply.
//!
//! In: an address, headers, a body. Out: status, some headers and body without any key; or a [`TransportError`]. A
//! message is sent once: no redirect is followed, nothing is retried. An interrupt ends the wait at once.

use super::BaseUrl;
use super::INTERRUPT_POLL;
use super::hints;
use super::redact::Redactor;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Billing, Fault};
use reqwest::header::{
    ACCEPT_ENCODING, CONTENT_ENCODING, CONTENT_TYPE, HeaderMap, HeaderValue, LOCATION,
};
use reqwest::{Client, RequestBuilder, Url};
use rustls::CertificateError;
use std::error::Error;
use std::future::Future;
use std::io;
use std::sync::LazyLock;
use std::time::{Duration, SystemTime};
use tokio::runtime::{Builder, Runtime};

/// Time limit for connecting.
pub(super) const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

/// The largest reply accepted, bytes.
pub(super) const MAX_REPLY_BYTES: usize = 16 * 1024 * 1024;

/// The UTF-8 byte order mark, which readers of JSON may ignore (RFC 8259, section 8.1).
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The async runtime of the whole process; calls block their own threads.
static RUNTIME: LazyLock<Result<Runtime, String>> = LazyLock::new(|| {
    Builder::new_multi_thread()
        .worker_threads(1)
        .thread_name("fabc-http")
        .enable_io()
        .enable_time()
        .build()
        .map_err(|error| error.to_string())
});

/// Sends messages to one host.
pub(super) struct Transport {
    client: Client,
    runtime: &'static Runtime,
    redactor: Redactor,
    timeout: Duration,
}

/// A reply.
pub(super) struct Incoming {
    pub status: u16,
    pub content_type: Option<String>,
    /// How the body is compressed.
    pub coding: Option<String>,
    /// Where a redirect leads.
    pub location: Option<String>,
    /// The wait that the headers ask for.
    pub wait: Option<Duration>,
    /// The body, without any key and without byte order marks.
    pub body: Vec<u8>,
}

/// Why there is no reply.
pub(super) enum TransportError {
    /// The user stopped it.
    Interrupted,
    /// Something failed.
    Failed(NoReply),
}

/// What failed, and the system's words for it.
pub(super) struct NoReply {
    pub obstacle: Obstacle,
    pub words: String,
}

/// What prevented a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Obstacle {
    /// Nothing listens at the port.
    Refused,
    /// The host's name cannot be resolved.
    UnknownHost,
    /// The network has no way there.
    Unrouted,
    /// The connection was not accepted in time.
    ConnectTimeout,
    /// This machine trusts no signer of the certificate.
    UntrustedCertificate,
    /// The certificate is not valid now.
    ExpiredCertificate,
    /// The certificate is for another name.
    CertificateOfAnotherName,
    /// The server answers TLS with something else.
    NoTls,
    /// TLS failed in another way.
    Tls,
    /// The connection could not be made for another reason.
    Unconnected,
    /// The reply was not complete in time.
    Timeout,
    /// What came is not HTTP.
    NoHttp,
    /// What came begins as HTTP does, and breaks its rules.
    BadHttp,
    /// The connection ended before the reply did.
    Cut,
    /// The reply is longer than the limit.
    TooLong,
}

impl Obstacle {
    /// Returns the fault, and whether the call may be billed.
    pub(super) fn fault(self) -> (Fault, Billing) {
        match self {
            Obstacle::Timeout => (Fault::TimedOut, Billing::Possibly),
            Obstacle::NoHttp | Obstacle::Cut => (Fault::ConnectionCut, Billing::Possibly),
            Obstacle::TooLong | Obstacle::BadHttp => (Fault::InvalidReply, Billing::Possibly),
            _ => (Fault::Unreachable, Billing::No),
        }
    }

    fn of(error: &reqwest::Error) -> Obstacle {
        let causes = || std::iter::successors(error.source(), |&cause| cause.source());
        let io: Vec<&io::Error> = causes().filter_map(|cause| cause.downcast_ref()).collect();
        let mut http = causes().filter_map(|cause| cause.downcast_ref::<hyper::Error>());
        let kind = |kind| io.iter().any(|error| error.kind() == kind);
        let tls = io
            .iter()
            .find_map(|error| innermost(error).get_ref()?.downcast_ref::<rustls::Error>());
        let is_connect = error.is_connect() || error.is_builder();
        if let Some(tls) = tls {
            Obstacle::of_tls(tls)
        } else if error.is_dns() {
            Obstacle::UnknownHost
        } else if error.is_timeout() {
            match is_connect {
                true => Obstacle::ConnectTimeout,
                false => Obstacle::Timeout,
            }
        } else if is_connect && kind(io::ErrorKind::ConnectionRefused) {
            Obstacle::Refused
        } else if kind(io::ErrorKind::NetworkUnreachable) || kind(io::ErrorKind::HostUnreachable) {
            Obstacle::Unrouted
        } else if is_connect {
            Obstacle::Unconnected
        } else if chain(error).contains("invalid HTTP") {
            Obstacle::NoHttp
        } else if http.any(hyper::Error::is_parse)
            || kind(io::ErrorKind::InvalidInput)
            || kind(io::ErrorKind::InvalidData)
        {
            // The latter two are those of a body in chunks.
            Obstacle::BadHttp
        } else {
            Obstacle::Cut
        }
    }

    fn of_tls(error: &rustls::Error) -> Obstacle {
        use CertificateError::{
            Expired, ExpiredContext, NotValidForName, NotValidForNameContext, NotValidYet,
            NotValidYetContext,
        };
        match error {
            rustls::Error::InvalidCertificate(why) => match why {
                Expired | ExpiredContext { .. } | NotValidYet | NotValidYetContext { .. } => {
                    Obstacle::ExpiredCertificate
                }
                NotValidForName | NotValidForNameContext { .. } => {
                    Obstacle::CertificateOfAnotherName
                }
                _ => Obstacle::UntrustedCertificate,
            },
            rustls::Error::InvalidMessage(_) => Obstacle::NoTls,
            _ => Obstacle::Tls,
        }
    }
}

/// Whether the system's proxy is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Proxy {
    OfTheSystem,
    None,
}

impl Proxy {
    /// Returns the proxy for a base URL; this computer is contacted without one.
    pub(super) fn to(base_url: &BaseUrl) -> Proxy {
        match base_url.is_loopback() {
            true => Proxy::None,
            false => Proxy::OfTheSystem,
        }
    }

    /// Returns the variable that names the proxy for an address, by the rules that most clients share.
    pub(super) fn variable(self, url: &Url) -> Option<String> {
        let set = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
        let either = |name: &str| {
            let names = [name.to_owned(), name.to_lowercase()];
            names.into_iter().find(|name| set(name).is_some())
        };
        let host = url.host_str().unwrap_or_default();
        let exempt = set("NO_PROXY").or_else(|| set("no_proxy"));
        let is_exempt = exempt.is_some_and(|list| {
            let mut entries = list
                .split(',')
                .map(|entry| entry.trim().trim_start_matches('.'));
            entries.any(|entry| {
                entry == "*"
                    || host
                        .strip_suffix(entry)
                        .is_some_and(|rest| rest.is_empty() || rest.ends_with('.'))
            })
        });
        if self == Proxy::None || is_exempt {
            return None;
        }
        either(&format!("{}_PROXY", url.scheme().to_uppercase())).or_else(|| either("ALL_PROXY"))
    }
}

impl Transport {
    /// Makes a transport; `timeout` covers one message from its start to the end of its reply.
    pub(super) fn new(
        redactor: Redactor,
        timeout: Duration,
        proxy: Proxy,
    ) -> Result<Transport, String> {
        let runtime = RUNTIME.as_ref().map_err(String::clone)?;
        // Fails if a provider is already installed, which is equally good.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let builder = Client::builder()
            .connect_timeout(CONNECT_TIMEOUT)
            .timeout(timeout)
            .redirect(reqwest::redirect::Policy::none())
            .retry(reqwest::retry::never())
            .referer(false)
            .default_headers(HeaderMap::from_iter([(
                ACCEPT_ENCODING,
                // Without this header a server may compress as it likes.
                HeaderValue::from_static("identity"),
            )]))
            .user_agent(concat!("fabc/", env!("CARGO_PKG_VERSION")));
        let builder = match proxy {
            Proxy::OfTheSystem => builder,
            Proxy::None => builder.no_proxy(),
        };
        let client = builder
            .build()
            .map_err(|error| chain(&error.without_url()))?;
        Ok(Transport {
            client,
            runtime,
            redactor,
            timeout,
        })
    }

    /// Returns the redactor of replies.
    pub(super) fn redactor(&self) -> &Redactor {
        &self.redactor
    }

    /// Sends a message and waits for its reply.
    pub(super) fn post(
        &self,
        url: &Url,
        headers: &HeaderMap,
        body: &[u8],
        interrupt: &Interrupt,
    ) -> Result<Incoming, TransportError> {
        let request = self.client.post(url.clone()).headers(headers.clone());
        self.send(request.body(body.to_vec()), MAX_REPLY_BYTES, interrupt)
    }

    /// Asks for something short: the reply may have at most `max_bytes`, and take at most `timeout`.
    pub(super) fn get(
        &self,
        url: &Url,
        headers: &HeaderMap,
        (max_bytes, timeout): (usize, Duration),
        interrupt: &Interrupt,
    ) -> Result<Incoming, TransportError> {
        let request = self.client.get(url.clone()).headers(headers.clone());
        let timeout = timeout.min(self.timeout);
        self.send(request.timeout(timeout), max_bytes, interrupt)
    }

    fn send(
        &self,
        request: RequestBuilder,
        max_bytes: usize,
        interrupt: &Interrupt,
    ) -> Result<Incoming, TransportError> {
        let exchange = self.exchange(request, max_bytes);
        let whole = self.runtime.block_on(unless_raised(exchange, interrupt));
        let whole = whole.ok_or(TransportError::Interrupted)?;
        whole.map_err(TransportError::Failed)
    }

    async fn exchange(
        &self,
        request: RequestBuilder,
        max_bytes: usize,
    ) -> Result<Incoming, NoReply> {
        let sent = request.send().await;
        let mut response = sent.map_err(|error| self.failed(error))?;
        let status = response.status().as_u16();
        let wait = hints::wait(response.headers(), SystemTime::now());
        let header = |name| {
            let value = response.headers().get(name)?.to_str().ok()?;
            Some(self.redactor.text(value))
        };
        let content_type = header(CONTENT_TYPE);
        let coding = header(CONTENT_ENCODING).filter(|it| !it.eq_ignore_ascii_case("identity"));
        let location = header(LOCATION);
        let mut body = Vec::new();
        while let Some(chunk) = response.chunk().await.map_err(|error| self.failed(error))? {
            body.extend_from_slice(&chunk);
            if body.len() > max_bytes {
                return Err(NoReply {
                    obstacle: Obstacle::TooLong,
                    words: format!("more than {max_bytes} bytes"),
                });
            }
        }
        let mut body = body.as_slice();
        while let Some(rest) = body.strip_prefix(BYTE_ORDER_MARK) {
            body = rest;
        }
        Ok(Incoming {
            status,
            content_type,
            coding,
            location,
            wait,
            body: self.redactor.body(body),
        })
    }

    fn failed(&self, error: reqwest::Error) -> NoReply {
        NoReply {
            obstacle: Obstacle::of(&error),
            words: self.redactor.text(&chain(&error.without_url())),
        }
    }
}

/// Returns the innermost of I/O errors within each other.
///
/// An I/O error's `source` is that of the error inside it, not the error inside.
fn innermost(error: &io::Error) -> &io::Error {
    let mut error = error;
    while let Some(inner) = error.get_ref().and_then(|inner| inner.downcast_ref()) {
        error = inner;
    }
    error
}

/// Waits for a result; `None` as soon as the interrupt is raised.
async fn unless_raised<F: Future>(future: F, interrupt: &Interrupt) -> Option<F::Output> {
    let mut future = std::pin::pin!(future);
    loop {
        if interrupt.is_raised() {
            return None;
        }
        if let Ok(output) = tokio::time::timeout(INTERRUPT_POLL, future.as_mut()).await {
            return Some(output);
        }
    }
}

/// Formats an error with its causes, outermost first.
fn chain(error: &reqwest::Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        words.push_str(": ");
        words.push_str(&error.to_string());
        cause = error.source();
    }
    words
}
