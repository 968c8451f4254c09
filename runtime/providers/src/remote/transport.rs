//! Sends one message and waits for the reply.
//!
//! In: an address, headers, a body. Out: status, wait and body without any key; or a [`TransportError`]. A message
//! is sent once: no redirect is followed, nothing is retried. An interrupt ends the wait at once.

use super::INTERRUPT_POLL;
use super::hints;
use super::redact::Redactor;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Billing, Fault};
use reqwest::header::HeaderMap;
use reqwest::{Client, Url};
use std::error::Error;
use std::future::Future;
use std::sync::LazyLock;
use std::time::{Duration, SystemTime};
use tokio::runtime::{Builder, Runtime};

/// Time limit for connecting.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

/// The largest reply accepted, bytes.
const MAX_REPLY_BYTES: usize = 16 * 1024 * 1024;

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
    /// The wait that the headers ask for.
    pub wait: Option<Duration>,
    /// The body, without any key.
    pub body: Vec<u8>,
}

/// Why there is no reply.
pub(super) enum TransportError {
    /// The user stopped it.
    Interrupted,
    /// Something failed.
    Failed {
        fault: Fault,
        billing: Billing,
        why: String,
    },
}

/// Whether the system's proxy is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Proxy {
    OfTheSystem,
    None,
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
            .user_agent(concat!("fabc/", env!("CARGO_PKG_VERSION")));
        let builder = match proxy {
            Proxy::OfTheSystem => builder,
            Proxy::None => builder.no_proxy(),
        };
        let client = builder
            .build()
            .map_err(|error| chain(error.without_url()))?;
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
        let exchange = self.exchange(url, headers, body);
        let whole = self.runtime.block_on(unless_raised(exchange, interrupt));
        whole.unwrap_or(Err(TransportError::Interrupted))
    }

    async fn exchange(
        &self,
        url: &Url,
        headers: &HeaderMap,
        body: &[u8],
    ) -> Result<Incoming, TransportError> {
        let request = self.client.post(url.clone()).headers(headers.clone());
        let sent = request.body(body.to_vec()).send().await;
        let mut response = sent.map_err(|error| self.failed(error))?;
        let status = response.status().as_u16();
        let wait = hints::wait(response.headers(), SystemTime::now());
        let mut body = Vec::new();
        while let Some(chunk) = response.chunk().await.map_err(|error| self.failed(error))? {
            body.extend_from_slice(&chunk);
            if body.len() > MAX_REPLY_BYTES {
                return Err(TransportError::Failed {
                    fault: Fault::InvalidReply,
                    billing: Billing::Possibly,
                    why: format!("the reply is longer than the limit of {MAX_REPLY_BYTES} bytes"),
                });
            }
        }
        Ok(Incoming {
            status,
            wait,
            body: self.redactor.body(&body),
        })
    }

    fn failed(&self, error: reqwest::Error) -> TransportError {
        let (fault, billing) = if error.is_connect() || error.is_builder() {
            (Fault::Unreachable, Billing::No)
        } else if error.is_timeout() {
            (Fault::TimedOut, Billing::Possibly)
        } else {
            (Fault::ConnectionCut, Billing::Possibly)
        };
        let why = self.redactor.text(&chain(error.without_url()));
        let why = match fault {
            Fault::TimedOut => format!(
                "no complete reply within {:.1} s: {why}",
                self.timeout.as_secs_f64()
            ),
            _ => why,
        };
        TransportError::Failed {
            fault,
            billing,
            why,
        }
    }
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
fn chain(error: reqwest::Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        words.push_str(": ");
        words.push_str(&error.to_string());
        cause = error.source();
    }
    words
}
