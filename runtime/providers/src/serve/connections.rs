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
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Sleep, sleep, timeout};

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
        let connection = http.serve_connection(TokioIo::new(Patient::new(stream)), service);
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

/// A connection that fails if its client accepts nothing for [`STALL_TIME`].
struct Patient {
    stream: TcpStream,
    stalled: Option<Pin<Box<Sleep>>>,
}

impl Patient {
    fn new(stream: TcpStream) -> Patient {
        Patient {
            stream,
            stalled: None,
        }
    }

    /// Limits the time for which writing is pending.
    fn limited<T>(
        &mut self,
        cx: &mut Context<'_>,
        written: Poll<io::Result<T>>,
    ) -> Poll<io::Result<T>> {
        if written.is_ready() {
            self.stalled = None;
            return written;
        }
        let stalled = self
            .stalled
            .get_or_insert_with(|| Box::pin(sleep(STALL_TIME)));
        match stalled.as_mut().poll(cx) {
            Poll::Ready(()) => Poll::Ready(Err(io::ErrorKind::TimedOut.into())),
            Poll::Pending => Poll::Pending,
        }
    }
}

impl AsyncRead for Patient {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, into)
    }
}

impl AsyncWrite for Patient {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(cx, bytes);
        self.limited(cx, written)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        let flushed = Pin::new(&mut self.stream).poll_flush(cx);
        self.limited(cx, flushed)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
