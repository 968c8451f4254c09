//! Tests of how often and after which waits is asked again.

use super::*;

fn calls_until_given_up(faults: impl Fn(u32) -> Fault) -> u32 {
    let retry = Retry {
        waits_in_all: Duration::MAX,
        ..Retry::default()
    };
    let mut tries = QuestionCalls::new(&retry);
    loop {
        let number = tries.begin();
        assert!(number < 100, "it never gives up");
        if tries.after(faults(number), None).is_err() {
            return number;
        }
    }
}

#[test]
fn each_fault_has_its_bound_and_all_together_have_one() {
    for fault in Fault::ALL {
        assert_eq!(
            calls_until_given_up(|_| fault),
            most_calls(fault),
            "{fault}"
        );
    }
    let faults = [Fault::RateLimited, Fault::ServerFailed, Fault::Unreachable];
    let mixed = calls_until_given_up(|number| faults[number as usize % 3]);
    assert_eq!(mixed, Retry::default().calls);
}

#[test]
fn waits_double_up_to_the_longest_and_chance_adds_at_most_as_much_again() {
    let retry = Retry {
        longest_wait: Duration::from_secs(4),
        ..Retry::default()
    };
    let mut tries = QuestionCalls::new(&retry);
    for expected in [1, 2, 4, 4, 4] {
        tries.begin();
        let Ok(wait) = tries.after(Fault::RateLimited, None) else {
            panic!("gave up");
        };
        let bounds = Duration::from_secs(expected)..=Duration::from_secs(2 * expected);
        assert!(bounds.contains(&wait), "{wait:?} for {expected} s");
    }
}

#[test]
fn a_longer_wait_that_the_provider_asks_for_is_kept_and_a_shorter_one_is_not() {
    let retry = Retry::default();
    let mut tries = QuestionCalls::new(&retry);
    tries.begin();
    let asked = Duration::from_secs(40);
    assert_eq!(tries.after(Fault::RateLimited, Some(asked)), Ok(asked));
    tries.begin();
    let Ok(wait) = tries.after(Fault::RateLimited, Some(Duration::ZERO)) else {
        panic!("gave up");
    };
    assert!(wait >= Duration::from_secs(2), "{wait:?}");
}

#[test]
fn waits_are_bounded_in_all() {
    let retry = Retry::default();
    let mut tries = QuestionCalls::new(&retry);
    tries.begin();
    let asked = Some(Duration::from_secs(400));
    assert_eq!(
        tries.after(Fault::RateLimited, asked),
        Ok(Duration::from_secs(400))
    );
    tries.begin();
    let Err(why) = tries.after(Fault::RateLimited, asked) else {
        panic!("waits 800 s");
    };
    assert!(why.contains("400.0 s") && why.contains("600.0 s"), "{why}");
    assert!(why.starts_with("after 2 calls; "), "{why}");
    let mut tries = QuestionCalls::new(&retry);
    tries.begin();
    let asked = Some(Duration::from_secs(601));
    let Err(why) = tries.after(Fault::RateLimited, asked) else {
        panic!("waits 601 s");
    };
    assert!(why.starts_with("after 1 call; "), "{why}");
}
