//! Tests of what a ledger remembers after a crash at any byte.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::calls::{Billing, Caps, Usage};
use fab_base::interrupt::Interrupt;

fn usd(dollars: f64) -> Option<Usd> {
    Some(Usd::from_dollars(dollars).unwrap())
}

fn call(key: &str, number: u32) -> Call<'_> {
    Call {
        model: "openai:some",
        key,
        number,
        at_most: usd(0.5),
    }
}

fn bought(text: &str) -> Reply {
    Reply {
        usage: Some(Usage {
            input_tokens: 700,
            cached_input_tokens: 0,
            output_tokens: 30,
            reasoning_tokens: Some(12),
        }),
        cost: usd(0.25),
        ..Reply::text(text)
    }
}

/// One answer after a failed try, a second answer, and a call that never ended.
fn eventful(folder: &Path) -> Budget {
    let budget = Budget::default();
    let mut ledger = Ledger::open(folder, &budget).unwrap();
    ledger.begin(&call("a", 1)).unwrap();
    let failed = FailedCall {
        fault: Fault::RateLimited,
        why: "wait".to_owned(),
        billing: Billing::No,
        cost: None,
        usage: None,
    };
    ledger.end(Err(&failed)).unwrap();
    ledger.begin(&call("a", 2)).unwrap();
    ledger.end(Ok(&bought("first"))).unwrap();
    ledger.keep("b", &Reply::text("cached")).unwrap();
    ledger.begin(&call("c", 1)).unwrap();
    ledger.end(Ok(&bought("third"))).unwrap();
    ledger.begin(&call("d", 1)).unwrap();
    drop(ledger);
    budget
}

#[test]
fn answers_are_remembered_and_an_open_call_counts_as_possibly_billed() {
    let folder = tempfile::tempdir().unwrap();
    let budget = eventful(folder.path());
    let noted = read(folder.path()).unwrap();
    let texts: Vec<_> = noted
        .answered
        .iter()
        .map(|(key, reply)| (key.as_str(), reply.text.as_str()))
        .collect();
    assert_eq!(texts, [("a", "first"), ("b", "cached"), ("c", "third")]);
    assert_eq!(noted.spent.calls, 4);
    assert_eq!(noted.spent.possibly_billed, 1);
    assert_eq!(Some(noted.spent.cost), usd(0.5));
    assert_eq!(Some(noted.spent.possibly), usd(0.5));
    assert_eq!(noted.spent.usage.input_tokens, 1400);
    assert_eq!(noted.faults, BTreeMap::from([(Fault::RateLimited, 1)]));
    assert_eq!(budget.spent(), noted.spent);
}

#[test]
#[ignore = "long"]
fn a_ledger_cut_off_at_any_byte_goes_on_and_loses_no_whole_line() {
    let folder = tempfile::tempdir().unwrap();
    eventful(folder.path());
    let path = folder.path().join(LEDGER_FILE);
    let whole = std::fs::read(&path).unwrap();
    for length in 0..=whole.len() {
        std::fs::write(&path, &whole[..length]).unwrap();
        let before = read(folder.path()).unwrap();
        let budget = Budget::default();
        budget.restore(&before.spent);
        let mut ledger = Ledger::open(folder.path(), &budget).unwrap();
        ledger.begin(&call("e", 1)).unwrap();
        ledger.end(Ok(&bought("later"))).unwrap();
        drop(ledger);
        let after = read(folder.path()).unwrap();
        let mut expected = before.answered.clone();
        expected.insert("e".to_owned(), bought("later"));
        assert_eq!(after.answered, expected, "cut at {length}");
        assert_eq!(after.spent.calls, before.spent.calls + 1, "cut at {length}");
        assert_eq!(after.spent, budget.spent(), "cut at {length}");
    }
}

#[test]
fn a_damaged_line_is_named_and_nothing_is_written_behind_it() {
    let folder = tempfile::tempdir().unwrap();
    eventful(folder.path());
    let path = folder.path().join(LEDGER_FILE);
    let text = std::fs::read_to_string(&path)
        .unwrap()
        .replacen("\"answered\"", "\"answred\"", 1);
    std::fs::write(&path, text).unwrap();
    let budget = Budget::default();
    let why = Ledger::open(folder.path(), &budget)
        .unwrap_err()
        .to_string();
    assert!(
        why.contains("calls.jsonl") && why.contains("line 4"),
        "{why}"
    );
}

#[test]
fn a_call_that_a_cap_forbids_is_not_noted() {
    let folder = tempfile::tempdir().unwrap();
    let caps = Caps {
        cost: None,
        calls: Some(0),
    };
    let budget = Budget::new(caps, &Interrupt::default());
    let mut ledger = Ledger::open(folder.path(), &budget).unwrap();
    assert!(matches!(
        ledger.begin(&call("a", 1)),
        Err(CallRefused::Budget(_))
    ));
    assert!(!folder.path().join(LEDGER_FILE).exists());
}

#[test]
fn a_ledger_that_cannot_be_written_lets_nothing_be_sent() {
    let folder = tempfile::tempdir().unwrap();
    let budget = Budget::default();
    let mut ledger = Ledger::open(&folder.path().join("absent"), &budget).unwrap();
    assert!(matches!(
        ledger.begin(&call("a", 1)),
        Err(CallRefused::Ledger(_))
    ));
    ledger.end(Ok(&bought("x"))).unwrap();
    assert_eq!(budget.spent().cost, Usd::ZERO);
}

#[test]
fn a_billed_failure_counts_in_tokens() {
    let folder = tempfile::tempdir().unwrap();
    let budget = Budget::default();
    let mut ledger = Ledger::open(folder.path(), &budget).unwrap();
    ledger.begin(&call("a", 1)).unwrap();
    let usage = Usage {
        input_tokens: 100,
        cached_input_tokens: 0,
        output_tokens: 9,
        reasoning_tokens: None,
    };
    let truncated = FailedCall {
        fault: Fault::Truncated,
        why: "cut off".to_owned(),
        billing: Billing::Possibly,
        cost: usd(1.5),
        usage: Some(usage),
    };
    ledger.end(Err(&truncated)).unwrap();
    ledger.begin(&call("a", 2)).unwrap();
    drop(ledger);
    let noted = read(folder.path()).unwrap();
    assert_eq!(noted.spent.usage, usage);
    assert_eq!(Some(noted.spent.cost), usd(1.5));
    assert_eq!(Some(noted.spent.possibly), usd(0.5));
}

#[test]
fn a_question_has_one_line_however_often_it_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let budget = Budget::default();
    let request = Request::new(crate::ModelRole::Text, Vec::new());
    for number in 1..=2 {
        // Opened twice, as a resumed rollout does.
        let mut ledger = Ledger::open(folder.path(), &budget).unwrap();
        ledger.asks(&Shop, &request);
        ledger.begin(&call(&request.key(), number)).unwrap();
    }
    let text = std::fs::read_to_string(folder.path().join(LEDGER_FILE)).unwrap();
    assert_eq!(text.matches("\"type\":\"question\"").count(), 1, "{text}");
    assert!(text.starts_with("{\"type\":\"question\""), "{text}");
}

/// A model that is only asked for its name.
struct Shop;

impl Model for Shop {
    fn name(&self) -> &str {
        "openai:some"
    }

    fn nature(&self) -> crate::ModelKind {
        crate::ModelKind::Model
    }

    fn ask(&self, _: &Request, _: &mut dyn Calls) -> Result<Reply, crate::ModelError> {
        Err(CallRefused::Interrupted.into())
    }
}
