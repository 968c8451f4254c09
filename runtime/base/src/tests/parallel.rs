//! Unit tests of `parallel`.

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
