//! Writing that cannot block its caller: a thread writes what waits in a bounded queue.
//!
//! In: items, and a function that writes one. Out: whether an item was queued, or written within a time limit. A writer
//! that blocks for good, such as a full pipe, holds its thread and no other; the thread ends with the process.

use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Items on their way to a writer.
#[derive(Debug)]
pub struct Outbox<T> {
    items: SyncSender<T>,
    /// What became of each item, in their order.
    written: Receiver<Result<(), String>>,
    n_waiting: usize,
}

impl<T: Send + 'static> Outbox<T> {
    /// Starts a thread that writes each item; it ends when the outbox is dropped and all that waits is written.
    ///
    /// - `most`: how many items may wait.
    pub fn new(
        most: usize,
        mut write: impl FnMut(T) -> Result<(), String> + Send + 'static,
    ) -> Outbox<T> {
        let (items, queue) = sync_channel::<T>(most);
        // As many answers as items may wait, and one of each is in the writer's hands.
        let (answers, written) = sync_channel(most + 2);
        thread::spawn(move || {
            for item in queue {
                // Nobody asks any more once the outbox is dropped; what waits is written nevertheless.
                let _ = answers.send(write(item));
            }
        });
        Outbox {
            items,
            written,
            n_waiting: 0,
        }
    }

    /// Queues an item without waiting; fails if the queue is full, or an item before it could not be written.
    pub fn send(&mut self, item: T) -> Result<(), String> {
        while let Ok(result) = self.written.try_recv() {
            self.n_waiting -= 1;
            result?;
        }
        match self.items.try_send(item) {
            Ok(()) => {
                self.n_waiting += 1;
                Ok(())
            }
            Err(TrySendError::Full(_)) => Err("its reader does not read".to_owned()),
            Err(TrySendError::Disconnected(_)) => Err("it is closed".to_owned()),
        }
    }

    /// Queues an item and waits until it is written, at most `longest`.
    pub fn write(&mut self, item: T, longest: Duration) -> Result<(), String> {
        self.send(item)?;
        let deadline = Instant::now() + longest;
        while self.n_waiting > 0 {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.written.recv_timeout(left) {
                Ok(result) => {
                    self.n_waiting -= 1;
                    result?;
                }
                Err(RecvTimeoutError::Timeout) => {
                    return Err(format!("it was not written within {longest:?}"));
                }
                Err(RecvTimeoutError::Disconnected) => return Err("it is closed".to_owned()),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "tests/outbox.rs"]
mod tests;
