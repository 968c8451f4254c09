//! Serves pages to browsers of this machine alone.
//!
//! In: an axum router. Out: its answers on 127.0.0.1, until the interrupt is raised. Requests that a foreign web page could
//! send through a local browser are refused. A client that stalls is disconnected, so that none keeps others out. The
//! router says what is served, and how long a body may be.

mod same_origin;

use axum::Router;
use axum::middleware::from_fn;
use fab_base::interrupt::Interrupt;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{sleep, timeout};
use tokio_io_timeout::TimeoutWriter;
use tower_http::timeout::RequestBodyTimeoutLayer;

/// How often the server checks the interrupt.
const LOOK_TIME: Duration = Duration::from_millis(50);

/// How many clients are served at once, and how long they are waited for.
#[derive(Clone, Debug)]
pub struct Limits {
    /// The most connections; the system keeps further clients waiting until one ends. 128 is an eighth of the files that a
    /// process may usually open.
    pub connections: usize,
    /// Time for the head of a request, and between two requests.
    pub head: Duration,
    /// Time for the next piece of a body, or until a client accepts the next piece of an answer.
    pub stall: Duration,
    /// Time for answers in progress once the interrupt is raised.
    pub last: Duration,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            connections: 128,
            head: Duration::from_secs(20),
            stall: Duration::from_secs(20),
            last: Duration::from_secs(5),
        }
    }
}

/// Why pages cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The port is unavailable.
    #[error("cannot listen on 127.0.0.1:{port}: {why}; port 0 takes any free one")]
    NoPort {
        /// The port.
        port: u16,
        /// The system's error.
        why: io::Error,
    },
    /// The system refused a thread or a timer.
    #[error("the server failed: {0}")]
    Failed(#[from] io::Error),
}

/// Serves a router on 127.0.0.1 until `interrupt` is raised; answers in progress are still completed.
///
/// - `port`: 0 takes any free port.
/// - `ready`: told the address as soon as connections are accepted.
pub fn serve(
    router: Router,
    port: u16,
    limits: &Limits,
    interrupt: &Interrupt,
    ready: &mut dyn FnMut(SocketAddr),
) -> Result<(), ServeError> {
    let router = router
        .layer(RequestBodyTimeoutLayer::new(limits.stall))
        .layer(from_fn(same_origin::refuse_foreign));
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_io()
        .enable_time()
        .build()?;
    let served = runtime.block_on(async {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).await;
        let listener = listener.map_err(|why| ServeError::NoPort { port, why })?;
        ready(listener.local_addr()?);
        answer(listener, router, limits, interrupt).await;
        Ok(())
    });
    runtime.shutdown_background();
    served
}

/// Answers connections until `interrupt` is raised.
async fn answer(listener: TcpListener, router: Router, limits: &Limits, interrupt: &Interrupt) {
    let places = Arc::new(Semaphore::new(limits.connections));
    let graceful = GracefulShutdown::new();
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new())
        .header_read_timeout(limits.head);
    while !interrupt.is_raised() {
        let (stream, place) = match timeout(LOOK_TIME, accept(&listener, &places)).await {
            Ok(Ok(accepted)) => accepted,
            Ok(Err(_)) => {
                // Out of files, or the client is gone already: an error here is never about the listener.
                sleep(LOOK_TIME).await;
                continue;
            }
            Err(_) => continue,
        };
        let service = TowerToHyperService::new(router.clone());
        let mut stream = TimeoutWriter::new(stream);
        stream.set_timeout(Some(limits.stall));
        let connection = http.serve_connection(TokioIo::new(Box::pin(stream)), service);
        let connection = graceful.watch(connection);
        tokio::spawn(async move {
            // An error ends this connection alone, and its client sees it.
            let _ = connection.await;
            drop(place);
        });
    }
    drop(listener);
    // A client that does not disconnect is not waited for any longer.
    let _ = timeout(limits.last, graceful.shutdown()).await;
}

async fn accept(
    listener: &TcpListener,
    places: &Arc<Semaphore>,
) -> io::Result<(TcpStream, OwnedSemaphorePermit)> {
    let place = Arc::clone(places).acquire_owned().await;
    let place = place.map_err(io::Error::other)?;
    let (stream, _) = listener.accept().await?;
    // The small pieces of a streamed answer should not wait for each other.
    stream.set_nodelay(true)?;
    Ok((stream, place))
}
