//! Tests of caps against providers whose reports are wrong: eight threads ask until the cap ends it.

use crate::support::*;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Budget, CallRefused, Caps, Ledger, Spent, Usage, Usd};
use fab_model::{Model, ModelError};
use fab_providers::remote::Gate;
use serde_json::{Value, json};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

/// A cap of twenty calls at the estimate of [`request`].
const CAP: Usd = Usd::from_nano(2000);

/// Returns the answer with another report of its usage; none if it is absent.
fn reporting(usage: Option<Value>) -> Response {
    let mut body = good_body("yes");
    match usage {
        Some(usage) => body["usage"] = usage,
        None => {
            body.as_object_mut().unwrap().remove("usage");
        }
    }
    status(200).json(body).delay(Duration::from_millis(2))
}

/// Lets eight threads ask until no call is permitted; returns what was spent and the number of requests.
fn until_capped(response: Response) -> (Spent, usize) {
    let provider = Provider::playing(vec![response]);
    let mut trial = Trial::of(provider.base_url());
    trial.shared.gate = Arc::new(Gate::new(8));
    let model = trial.model();
    let caps = Caps {
        cost: Some(CAP),
        calls: None,
    };
    let budget = Budget::new(caps, &Interrupt::default());
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| {
                loop {
                    match model.ask(&request(), &mut Ledger::unwritten(&budget)) {
                        Err(ModelError::NotSent(CallRefused::Budget(_))) => return,
                        Ok(_) | Err(ModelError::Failed { .. }) => {}
                        Err(error) => panic!("{error}"),
                    }
                }
            });
        }
    });
    (budget.spent(), provider.calls())
}

#[test]
fn a_usage_that_is_no_report_counts_as_reserved_and_reaches_the_cap() {
    let reports = [
        None,
        Some(Value::Null),
        Some(json!({ "prompt_tokens": 0, "completion_tokens": 0 })),
        Some(json!({ "prompt_tokens": 0, "completion_tokens": 5 })),
        Some(json!({ "prompt_tokens": 5, "completion_tokens": 0 })),
        Some(json!({ "prompt_tokens": "many", "completion_tokens": -3 })),
        Some(json!({ "prompt_tokens": 1.5, "completion_tokens": 1e300 })),
        Some(json!(["tokens"])),
    ];
    for report in reports {
        let what = format!("{report:?}");
        let (spent, sent) = until_capped(reporting(report));
        assert_eq!((spent.calls, sent), (20, 20), "{what}");
        assert_eq!(
            (spent.cost, spent.possibly, spent.unreported),
            (Usd::ZERO, CAP, 20),
            "{what}"
        );
        assert_eq!(spent.known_cost(), None, "{what}");
        assert_eq!(spent.usage, Usage::default(), "{what}");
    }
}

#[test]
fn a_provider_that_bills_ten_times_the_estimate_passes_the_cap_by_the_first_calls_alone() {
    let bill = json!({ "prompt_tokens": 40, "completion_tokens": 60 });
    let (spent, sent) = until_capped(reporting(Some(bill)));
    assert_eq!(spent.calls, sent as u64);
    // At most eight calls were reserved 100 and cost 1000; then each is reserved 1000.
    assert!(spent.cost <= Usd::from_nano(2000 + 8 * 900), "{spent:?}");
    assert!(spent.cost + Usd::from_nano(1000) > CAP, "{spent:?}");
}

#[test]
fn a_bill_beyond_all_numbers_ends_it_at_once() {
    let bill = json!({ "prompt_tokens": 1_000_000_000_000_000_000_u64, "completion_tokens": 1 });
    let (spent, _) = until_capped(reporting(Some(bill)));
    assert!((1..=8).contains(&spent.calls), "{spent:?}");
}

#[test]
fn a_billed_failure_counts_in_tokens_and_in_cost() {
    let mut cut = good_body("yes, bu");
    cut["choices"][0]["finish_reason"] = json!("length");
    let (spent, sent) = until_capped(status(200).json(cut));
    // 15 tokens at 10 each; the second question onwards reserves them.
    let sent = sent as u64;
    assert_eq!((spent.calls, spent.possibly_billed), (sent, 0));
    assert_eq!(spent.usage.input_tokens, 10 * sent);
    assert_eq!(spent.usage.output_tokens, 5 * sent);
    assert_eq!(spent.cost, Usd::from_nano(150 * sent));
}
