//! Independent jobs on several threads, with results in the jobs' order.

use std::io;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

/// Runs the jobs `0..count` and returns their results, in that order.
///
/// - `threads`: at least 1; never more threads than jobs are started.
/// - `job`: returns `None` if it was stopped; no further job starts after that.
/// - `finished`: called with the number of finished jobs, one call at a time.
///
/// The first failure stops the remaining jobs and is returned; so is a failure to start a thread.
pub fn in_parallel<T: Send, E: Send + From<io::Error>>(
    count: usize,
    threads: usize,
    job: impl Fn(usize) -> Result<Option<T>, E> + Sync,
    finished: impl Fn(usize) + Sync,
) -> Result<Vec<Option<T>>, E> {
    let (next, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let done = Mutex::new((0, (0..count).map(|_| None).collect::<Vec<Option<T>>>()));
    let failure = Mutex::new(None);
    const NO_PANIC: &str = "no job panics while it holds a lock";
    let stop_with = |why: E| {
        stopped.store(true, Ordering::Relaxed);
        failure.lock().expect(NO_PANIC).get_or_insert(why);
    };
    let work = || {
        while !stopped.load(Ordering::Relaxed) {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return;
            }
            match job(index) {
                Ok(Some(result)) => {
                    let mut done = done.lock().expect(NO_PANIC);
                    done.0 += 1;
                    done.1[index] = Some(result);
                    finished(done.0);
                }
                Ok(None) => stopped.store(true, Ordering::Relaxed),
                Err(why) => stop_with(why),
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..threads.max(1).min(count) {
            if let Err(error) = thread::Builder::new().spawn_scoped(scope, work) {
                let why = format!("cannot start {threads} threads: {error}");
                stop_with(io::Error::new(error.kind(), why).into());
            }
        }
    });
    match failure.into_inner().expect(NO_PANIC) {
        Some(why) => Err(why),
        None => Ok(done.into_inner().expect(NO_PANIC).1),
    }
}

#[cfg(test)]
#[path = "tests/parallel.rs"]
mod tests;
