//! Rollouts with a provider of whose calls one in ten fails, in every way: each ends in a named outcome, every call is
//! accounted for, and failed rollouts are resumed.

use super::support::{self, Trial};
use fab_agent::outcome::Outcome;
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_model::calls::{Fault, ledger};
use fab_providers::Remote;
use fab_providers::remote::{Answers, BaseUrl, Gate, Retry, Settings, Shared, Wire};
use fab_standins::Geometric;
use fab_test_provider::{Provider, Question, Response};
use fab_world::Look;
use serde_json::json;
use std::collections::BTreeSet;
use std::fs;
use std::sync::Arc;
use std::time::Duration;

const ROLLOUTS: u32 = 16;

/// Pseudo-random numbers, the same each time (Steele, Lea, Flood 2014: SplitMix64).
fn drawn(number: usize) -> u64 {
    let mut bits = (number as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ (bits >> 31)
}

fn one_in_ten(number: usize, question: &Question) -> Response {
    let drawn = drawn(number);
    let answer = question.answer_of(&Geometric);
    if !drawn.is_multiple_of(10) {
        return answer;
    }
    let ended = |reason: &str| {
        let answer = answer.clone();
        answer.edit(|body| body["choices"][0]["finish_reason"] = json!(reason))
    };
    match drawn / 10 % 10 {
        0 => Response::error(429, "rate_limit_exceeded", "slow down").header("retry-after", "0"),
        1 => Response::error(429, "insufficient_quota", "you have no credit left"),
        2 => Response::error(503, "server_error", "overloaded"),
        3 => answer.delay(Duration::from_secs(3600)),
        4 => answer.cut(),
        5 => Response::status(200).json("<html>bad gateway</html>"),
        6 => answer.edit(|body| {
            let refusal = json!({ "role": "assistant", "content": null, "refusal": "no" });
            body["choices"][0]["message"] = refusal;
        }),
        7 => ended("content_filter"),
        8 => ended("length"),
        _ => Response::error(401, "invalid_api_key", "wrong key"),
    }
}

/// The provider's model, with waits a thousand times shorter than usual.
fn remote(provider: &Provider) -> Remote {
    let address = BaseUrl::parse(provider.base_url()).unwrap();
    let settings = Settings {
        timeout: Duration::from_millis(700),
        retry: Retry {
            first_wait: Duration::from_millis(1),
            longest_wait: Duration::from_millis(60),
            waits_in_all: Duration::from_millis(600),
            ..Retry::default()
        },
        ..Settings::new("test", "geometric", Wire::OpenaiChat, address)
    };
    let shared = Shared {
        tell: Arc::new(|_| {}),
        gate: Arc::new(Gate::new(4)),
        answers: Arc::new(Answers::none()),
        interrupt: Interrupt::default(),
        hidden: Vec::new(),
    };
    Remote::new(settings, shared).unwrap()
}

#[test]
#[ignore = "long"]
fn every_rollout_ends_in_a_named_outcome_and_every_call_is_accounted_for() {
    let folder = tempfile::tempdir().unwrap();
    let program = support::small_task();
    let provider = Provider::start(one_in_ten);
    let model = remote(&provider);
    let models = Models {
        vision: &model,
        text: &model,
    };
    let mut trial = Trial::new(&program, folder.path(), Look::default());
    let (mut failed, mut faults, mut calls) = (Vec::new(), BTreeSet::new(), 0);
    for repetition in 0..ROLLOUTS {
        trial.repetition = repetition;
        let run = folder.path().join(format!("run-{repetition}"));
        let report = trial.run(models, &run, &mut |_| {});
        match report.outcome {
            Outcome::HorizonReached => {}
            Outcome::ModelFailed => {
                let journal = fs::read_to_string(run.join("rollout.jsonl")).unwrap();
                let named = Fault::ALL
                    .iter()
                    .any(|fault| journal.contains(&format!("\"fault\":\"{fault}\"")));
                assert!(named, "the journal names no fault: {journal}");
                failed.push((repetition, run));
            }
            other => panic!("rollout {repetition} ended {other:?}"),
        }
        calls += report.took.spent.calls;
        faults.extend(
            report
                .took
                .faults
                .keys()
                .map(|fault| fault.name().to_owned()),
        );
    }
    assert_eq!(calls, provider.calls() as u64);
    assert!(faults.len() >= 5, "only {faults:?} came up");
    assert!(
        !failed.is_empty() && failed.len() < ROLLOUTS as usize / 2,
        "{failed:?}"
    );

    for (repetition, run) in failed {
        trial.repetition = repetition;
        let answered = ledger::read(&run).unwrap().answered.len();
        let outcome = (0..5).map(|_| trial.run(models, &run, &mut |_| {}).outcome);
        let reached = outcome
            .into_iter()
            .any(|outcome| outcome == Outcome::HorizonReached);
        assert!(reached, "rollout {repetition} was gone on with in vain");
        assert!(ledger::read(&run).unwrap().answered.len() > answered);
    }
}
