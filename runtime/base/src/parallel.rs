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
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn results_come_in_the_jobs_order_on_any_number_of_threads() {
        let expected: Vec<_> = (0..50).map(|job| Some(job * job)).collect();
        for threads in [1, 2, 7, 99] {
            let told = Mutex::new(Vec::new());
            let results: Result<_, io::Error> = in_parallel(
                50,
                threads,
                |job| Ok(Some(job * job)),
                |done| told.lock().unwrap().push(done),
            );
            assert_eq!(results.unwrap(), expected);
            assert_eq!(told.into_inner().unwrap(), (1..=50).collect::<Vec<usize>>());
        }
    }

    #[test]
    fn a_failure_and_a_stop_end_the_rest() {
        let begun = AtomicUsize::new(0);
        let job = |index: usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            if index == 3 {
                Err(io::Error::other("job 3"))
            } else {
                Ok(Some(index))
            }
        };
        let failed = in_parallel(1000, 1, job, |_| {}).unwrap_err();
        assert_eq!(failed.to_string(), "job 3");
        assert_eq!(begun.into_inner(), 4);
        let begun = AtomicUsize::new(0);
        let job = |index: usize| -> Result<_, io::Error> {
            begun.fetch_add(1, Ordering::Relaxed);
            Ok((index < 2).then_some(index))
        };
        let stopped = in_parallel(1000, 1, job, |_| {}).unwrap();
        assert_eq!(begun.into_inner(), 3);
        assert_eq!(stopped[..4], [Some(0), Some(1), None, None]);
        assert_eq!(stopped.len(), 1000);
    }
}
