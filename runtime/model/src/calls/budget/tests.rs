//! Tests of caps: by cases, with threads, and over random interleavings of calls.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::Reply;
use crate::calls::FailedCall;
use proptest::prelude::*;
use std::thread;

fn usd(dollars: f64) -> Option<Usd> {
    Some(Usd::from_dollars(dollars).unwrap())
}

fn capped(cost: Option<Usd>) -> Budget {
    Budget::new(Caps { cost, calls: None }, &Interrupt::default())
}

fn reply(cost: Option<Usd>) -> Reply {
    Reply {
        cost,
        ..Reply::text("yes")
    }
}

fn failed(billing: Billing) -> FailedCall {
    FailedCall {
        billing,
        ..FailedCall::UNRESOLVED
    }
}

#[test]
fn money_is_set_aside_before_a_call_and_the_rest_given_back_after_it() {
    let budget = capped(usd(1.0));
    budget.reserve(usd(0.6)).unwrap();
    budget.end(usd(0.6), Some(Ok(&reply(usd(0.1)))));
    budget.reserve(usd(0.9)).unwrap();
    budget.end(usd(0.9), Some(Err(&failed(Billing::Possibly))));
    let refused = budget.reserve(usd(0.01)).unwrap_err().to_string();
    assert!(refused.contains("1.0000 USD of the cap"), "{refused}");
    let spent = budget.spent();
    assert_eq!((spent.calls, spent.possibly_billed), (2, 1));
    assert_eq!(Some(spent.cost), usd(0.1));
    assert_eq!(Some(spent.at_most()), usd(1.0));
}

#[test]
fn calls_under_way_count_towards_the_cap() {
    let caps = Caps {
        cost: None,
        calls: Some(2),
    };
    let earlier = Spent {
        calls: 1,
        ..Spent::default()
    };
    let budget = Budget::new(caps, &Interrupt::default());
    budget.restore(&earlier);
    budget.reserve(None).unwrap();
    assert!(budget.reserve(None).is_err());
    budget.end(None, Some(Err(&failed(Billing::No))));
    assert!(budget.reserve(None).is_err());
    assert_eq!(budget.spent().possibly_billed, 0);
}

#[test]
fn a_cap_on_an_unknown_cost_lets_nothing_through() {
    let budget = capped(usd(5.0));
    let refused = budget.reserve(None).unwrap_err();
    assert!(refused.to_string().contains("is unknown"));
    let free = Budget::default();
    free.reserve(None).unwrap();
    free.end(None, Some(Ok(&reply(None))));
    assert_eq!(free.spent().unpriced, 1);
}

#[test]
fn a_call_without_usage_counts_as_reserved_and_as_no_fact() {
    let budget = capped(usd(1.0));
    for _ in 0..2 {
        budget.reserve(usd(0.5)).unwrap();
        budget.end(usd(0.5), Some(Ok(&reply(None))));
    }
    assert!(budget.reserve(usd(0.5)).is_err());
    let spent = budget.spent();
    assert_eq!((spent.unreported, spent.cost), (2, Usd::ZERO));
    assert_eq!(
        (spent.known_cost(), spent.priced_at_most()),
        (None, usd(1.0))
    );
    assert_eq!(
        spent.in_words(),
        "at most 1.0000 USD; 2 calls without reported usage"
    );
    assert_eq!(spent.tokens_in_words(), "tokens at least 0 in, 0 out");
}

/// Waits until a thread waits for the budget.
fn until_waiting(budget: &Budget, waiting: &thread::ScopedJoinHandle<'_, bool>) {
    // The wait gives the lock back; a thread that was refused would have ended.
    for _ in 0..20 {
        drop(budget.state());
        thread::sleep(Duration::from_millis(1));
        assert!(!waiting.is_finished(), "it did not wait");
    }
}

#[test]
fn a_reservation_that_does_not_fit_waits_for_calls_under_way() {
    let (free, billed) = (failed(Billing::No), failed(Billing::Possibly));
    for (end, fits) in [
        (Some(Err(&free)), true),
        (None, true),
        (Some(Err(&billed)), false),
    ] {
        let budget = capped(usd(1.0));
        thread::scope(|scope| {
            budget.reserve(usd(0.6)).unwrap();
            let waiting = scope.spawn(|| budget.reserve(usd(0.6)).is_ok());
            until_waiting(&budget, &waiting);
            budget.end(usd(0.6), end);
            assert_eq!(waiting.join().unwrap(), fits);
        });
    }
}

#[test]
fn an_interrupt_ends_the_waiting() {
    let interrupt = Interrupt::default();
    let caps = Caps {
        cost: usd(1.0),
        calls: None,
    };
    let budget = Budget::new(caps, &interrupt);
    thread::scope(|scope| {
        budget.reserve(usd(1.0)).unwrap();
        let interrupted = || matches!(budget.reserve(usd(1.0)), Err(CallRefused::Interrupted));
        let waiting = scope.spawn(interrupted);
        until_waiting(&budget, &waiting);
        interrupt.raise();
        assert!(waiting.join().unwrap());
    });
}

/// Lets eight threads make calls that cost `factor` times the estimate; returns how many were made.
fn eight_threads(budget: &Budget, calls_each: u32, estimated: Option<Usd>, factor: f64) -> u64 {
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| {
                for _ in 0..calls_each {
                    if budget.reserve(estimated).is_err() {
                        return;
                    }
                    thread::yield_now();
                    let cost = Usd::from_dollars(estimated.unwrap().dollars() * factor);
                    budget.end(estimated, Some(Ok(&reply(cost))));
                }
            });
        }
    });
    budget.spent().calls
}

#[test]
fn a_cap_that_is_high_enough_stops_nothing() {
    // Each call reserves a fifth of the cap, so not even eight fit at once; together they cost 0.288.
    let budget = capped(usd(0.5));
    assert_eq!(eight_threads(&budget, 9, usd(0.1), 0.04), 72);
    assert_eq!(budget.spent().cost, Usd::from_dollars(0.288).unwrap());
}

#[test]
fn a_provider_that_bills_ten_times_the_estimate_passes_the_cap_by_the_calls_under_way() {
    let budget = capped(usd(1.0));
    eight_threads(&budget, 100, usd(0.01), 10.0);
    let spent = budget.spent();
    assert!(spent.cost > Usd::from_dollars(0.9).unwrap(), "{spent:?}");
    assert!(
        spent.cost <= Usd::from_dollars(1.0 + 8.0 * 0.09).unwrap(),
        "{spent:?}"
    );
}

/// What a provider does with a call.
#[derive(Clone, Copy, Debug)]
enum Fate {
    /// It bills this many hundredths of the estimate.
    Bills(u64),
    BillsAndFails(u64),
    ReportsNothing,
    IsCut,
    IsRefused,
}

fn fate() -> impl Strategy<Value = Fate> {
    prop_oneof![
        (0..=100u64).prop_map(Fate::Bills),
        (0..=2000u64).prop_map(Fate::Bills),
        (0..=2000u64).prop_map(Fate::BillsAndFails),
        Just(Fate::ReportsNothing),
        Just(Fate::IsCut),
        Just(Fate::IsRefused),
    ]
}

#[derive(Clone, Debug)]
struct Flight {
    at_most: Usd,
    fate: Fate,
}

impl Flight {
    /// Returns what the call reports, and what it counts for.
    fn costs(&self) -> (Option<Usd>, Usd) {
        match self.fate {
            Fate::Bills(percent) | Fate::BillsAndFails(percent) => {
                let cost = Usd::from_nano(self.at_most.nano() * percent / 100);
                (Some(cost), cost)
            }
            Fate::ReportsNothing | Fate::IsCut => (None, self.at_most),
            Fate::IsRefused => (None, Usd::ZERO),
        }
    }

    fn land(&self, state: &mut State) {
        let (cost, _) = self.costs();
        let answer = reply(cost);
        let failure = |billing| FailedCall {
            cost,
            ..failed(billing)
        };
        let (possibly_billed, unbilled) = (failure(Billing::Possibly), failure(Billing::No));
        let end = match self.fate {
            Fate::Bills(_) | Fate::ReportsNothing => Ok(&answer),
            Fate::BillsAndFails(_) | Fate::IsCut => Err(&possibly_billed),
            Fate::IsRefused => Err(&unbilled),
        };
        state.end(Some(self.at_most), Some(end));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// In any order of beginnings and ends: what is granted fits, nothing is refused while calls are under way, and
    /// the cap is passed at most by what the calls under way at the last grant cost beyond their reservations.
    #[test]
    fn spending_keeps_to_the_bound(
        cap in 1..5_000u64,
        calls in prop::collection::vec((0..1_000u64, fate()), 1..40),
        order in prop::collection::vec((any::<bool>(), 0..8usize), 200),
    ) {
        let cap = Usd::from_nano(cap);
        let caps = Caps { cost: Some(cap), calls: None };
        let mut state = State::default();
        let mut queue = calls.into_iter().peekable();
        let (mut flying, mut at_last_grant): (Vec<Flight>, Vec<Flight>) = Default::default();
        // After the drawn order, everything lands.
        let order = order.into_iter().chain([(false, 0); 8]);
        let mut is_over = false;
        for (begins, which) in order {
            if begins && !is_over && flying.len() < 8 {
                let Some((nano, fate)) = queue.peek().copied() else { continue };
                let at_most = Usd::from_nano(nano);
                match state.admit(caps, Some(at_most)) {
                    Ok(true) => {
                        flying.push(Flight { at_most, fate });
                        let reserved: Usd = flying.iter().map(|it| it.at_most).sum();
                        prop_assert!(state.spent.at_most() + reserved <= cap);
                        at_last_grant.clone_from(&flying);
                        queue.next();
                    }
                    Ok(false) => prop_assert!(!flying.is_empty()),
                    Err(_) => {
                        prop_assert!(flying.is_empty());
                        is_over = true;
                    }
                }
            } else if !flying.is_empty() {
                flying.swap_remove(which % flying.len()).land(&mut state);
            }
        }
        prop_assert!(flying.is_empty() && state.under_way.is_empty());
        let beyond = at_last_grant.iter().map(|it| {
            let [cost, at_most] = [it.costs().1, it.at_most].map(Usd::nano);
            Usd::from_nano(cost.saturating_sub(at_most))
        });
        prop_assert!(state.spent.at_most() <= cap + beyond.sum());
    }
}
