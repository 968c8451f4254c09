//! Sends one message and waits for the reply.
//!
//! In: an address, headers, a body. Out: status, some headers and body without any key; or a [`NoReply`]. A
//! message is sent once: no redirect is followed, nothing is retried. An interrupt ends the wait at once.

use super::redact::Redactor;
use super::{INTERRUPT_POLL, Settings, hints};
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Billing, Fault};
use reqwest::header::{ACCEPT_ENCODING, CONTENT_TYPE, HeaderMap, HeaderValue, LOCATION};
use reqwest::{Client, RequestBuilder};
use std::error::Error;
use std::future::Future;
use std::io;
use std::sync::LazyLock;
use std::time::{Duration, SystemTime};
use tokio::runtime::{Builder, Runtime};

/// Time limit for connecting.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

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
    pub client: Client,
    runtime: &'static Runtime,
    /// Hides keys in replies.
    pub redactor: Redactor,
}

/// A reply.
pub(super) struct Incoming {
    pub status: u16,
    pub content_type: Option<String>,
    /// Where a redirect leads.
    pub location: Option<String>,
    /// The wait that the headers ask for.
    pub wait: Option<Duration>,
    /// The body, without any key.
    pub body: Vec<u8>,
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
    /// The connection could not be made for another reason.
    Unconnected,
    /// This machine does not trust the server's certificate.
    Certificate,
    /// TLS failed in another way.
    Tls,
    Timeout,
    NoHttp,
    Cut,
    TooLong,
    /// The user stopped it.
    Interrupted,
}

impl Obstacle {
    /// Says what happened.
    pub(super) fn words(self) -> &'static str {
        match self {
            Obstacle::Refused => "the connection was refused",
            Obstacle::Unconnected => "no connection could be made",
            Obstacle::Certificate => "the server's certificate is not trusted",
            Obstacle::Tls => "no encrypted connection could be made",
            Obstacle::Timeout => "no complete reply came in time",
            Obstacle::NoHttp => "the reply is not HTTP",
            Obstacle::Cut => "the connection ended before the reply was complete",
            Obstacle::TooLong => "the reply is longer than the limit",
            Obstacle::Interrupted => "interrupted before the whole answer was there",
        }
    }

    /// Returns the fault, and whether the call may be billed.
    pub(super) fn fault(self) -> (Fault, Billing) {
        match self {
            Obstacle::Timeout => (Fault::TimedOut, Billing::Possibly),
            Obstacle::TooLong => (Fault::InvalidReply, Billing::Possibly),
            Obstacle::NoHttp | Obstacle::Cut | Obstacle::Interrupted => {
                (Fault::ConnectionCut, Billing::Possibly)
            }
            _ => (Fault::Unreachable, Billing::No),
        }
    }

    fn of(error: &reqwest::Error, words: &str) -> Obstacle {
        let mut io = causes(error).filter_map(|cause| cause.downcast_ref::<io::Error>());
        let mut http = causes(error).filter_map(|cause| cause.downcast_ref::<hyper::Error>());
        if words.contains("invalid peer certificate") {
            Obstacle::Certificate
        } else if words.contains("received corrupt message")
            || words.contains("received fatal alert")
        {
            Obstacle::Tls
        } else if io.any(|error| error.kind() == io::ErrorKind::ConnectionRefused) {
            Obstacle::Refused
        } else if error.is_connect() || error.is_builder() {
            Obstacle::Unconnected
        } else if error.is_timeout() {
            Obstacle::Timeout
        } else if http.any(hyper::Error::is_parse) {
            Obstacle::NoHttp
        } else {
            Obstacle::Cut
        }
    }
}

impl Transport {
    /// Makes a transport; the settings' time limit covers one message from its start to the end of its reply.
    ///
    /// This computer is contacted without a proxy.
    pub(super) fn new(redactor: Redactor, settings: &Settings) -> Result<Transport, String> {
        let runtime = RUNTIME.as_ref().map_err(String::clone)?;
        // Fails if a provider is already installed, which is equally good.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let mut builder = Client::builder()
            .connect_timeout(CONNECT_TIMEOUT)
            .timeout(settings.timeout)
            .redirect(reqwest::redirect::Policy::none())
            .retry(reqwest::retry::never())
            .referer(false)
            .default_headers(HeaderMap::from_iter([(
                ACCEPT_ENCODING,
                // Without this header a server may compress as it likes.
                HeaderValue::from_static("identity"),
            )]))
            .user_agent(concat!("fabc/", env!("CARGO_PKG_VERSION")));
        if settings.base_url.is_loopback() {
            builder = builder.no_proxy();
        }
        let client = builder.build();
        Ok(Transport {
            client: client.map_err(|error| chain(&error.without_url()))?,
            runtime,
            redactor,
        })
    }

    /// Waits for a result; `None` as soon as the interrupt is raised.
    pub(super) fn wait<F: Future>(&self, future: F, interrupt: &Interrupt) -> Option<F::Output> {
        self.runtime.block_on(async {
            let mut future = std::pin::pin!(future);
            while !interrupt.is_raised() {
                if let Ok(output) = tokio::time::timeout(INTERRUPT_POLL, future.as_mut()).await {
                    return Some(output);
                }
            }
            None
        })
    }

    /// Sends a message of the client and waits for its reply, which may have at most `max_bytes`.
    pub(super) fn send(
        &self,
        request: RequestBuilder,
        max_bytes: usize,
        interrupt: &Interrupt,
    ) -> Result<Incoming, NoReply> {
        let whole = self.wait(self.exchange(request, max_bytes), interrupt);
        whole.unwrap_or(Err(NoReply {
            obstacle: Obstacle::Interrupted,
            words: "interrupted".to_owned(),
        }))
    }

    async fn exchange(
        &self,
        request: RequestBuilder,
        max_bytes: usize,
    ) -> Result<Incoming, NoReply> {
        let sent = request.send().await;
        let mut response = sent.map_err(|error| self.failed(error))?;
        let headers = response.headers();
        let header = |name| Some(self.redactor.text(headers.get(name)?.to_str().ok()?));
        let mut incoming = Incoming {
            status: response.status().as_u16(),
            content_type: header(CONTENT_TYPE),
            location: header(LOCATION),
            wait: hints::wait(headers, SystemTime::now()),
            body: Vec::new(),
        };
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
        incoming.body = self.redactor.body(&body);
        Ok(incoming)
    }

    fn failed(&self, error: reqwest::Error) -> NoReply {
        let error = error.without_url();
        let words = chain(&error);
        NoReply {
            obstacle: Obstacle::of(&error, &words),
            words: self.redactor.text(&words),
        }
    }
}

/// Returns what caused an error, and what caused that.
fn causes(error: &reqwest::Error) -> impl Iterator<Item = &(dyn Error + 'static)> {
    std::iter::successors(error.source(), |&cause| cause.source())
}

/// Formats an error with its causes, outermost first.
fn chain(error: &reqwest::Error) -> String {
    let words = causes(error).map(|cause| format!(": {cause}"));
    format!("{error}{}", words.collect::<String>())
}
