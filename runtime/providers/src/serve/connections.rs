//! Accepts connections, and closes those that stall, so that no client keeps others out.
//!
//! In: a listener and what answers on it. Out: nothing, once the interrupt is raised and the answers in progress are
//! sent. The system keeps clients beyond the limit waiting until a connection ends.

use super::LOOK_TIME;
use axum::Router;
use fab_base::interrupt::Interrupt;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{sleep, timeout};
use tokio_io_timeout::TimeoutWriter;

/// The most connections at once, an eighth of the files that a process may usually open.
const CONNECTIONS: usize = 128;
/// Time limit for the head of a request, and between two requests.
const HEAD_TIME: Duration = Duration::from_secs(20);
/// How long a client may accept nothing of an answer.
const STALL_TIME: Duration = Duration::from_secs(20);
/// Time limit for answers in progress at shutdown.
const LAST_TIME: Duration = Duration::from_secs(5);

/// Answers connections until `interrupt` is raised.
pub(super) async fn answer(listener: TcpListener, router: Router, interrupt: &Interrupt) {
    let places = Arc::new(Semaphore::new(CONNECTIONS));
    let graceful = GracefulShutdown::new();
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEAD_TIME);
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
        stream.set_timeout(Some(STALL_TIME));
        let connection = http.serve_connection(TokioIo::new(Box::pin(stream)), service);
        let connection = graceful.watch(connection);
        tokio::spawn(async move {
            // An error ends this connection alone, and its client sees it.
            let _ = connection.await;
            drop(place);
        });
    }
    drop(listener);
    // After a while, do not wait any longer for a client to disconnect.
    let _ = timeout(LAST_TIME, graceful.shutdown()).await;
}

async fn accept(
    listener: &TcpListener,
    places: &Arc<Semaphore>,
) -> io::Result<(TcpStream, OwnedSemaphorePermit)> {
    let place = places.clone().acquire_owned().await;
    let place = place.map_err(io::Error::other)?;
    let (stream, _) = listener.accept().await?;
    // The small pieces of a streamed answer should not wait for each other.
    stream.set_nodelay(true)?;
    Ok((stream, place))
}
