//! Tests that answers are bought once: cached by everything they depend on, and asked for by one thread at a time.

use crate::support::*;
use fab_base::cache::Cache;
use fab_model::calls::{Billing, Budget, Fault, Ledger, Usd};
use fab_model::{Model, Request};
use fab_providers::remote::{Answers, Wire};
use std::fs;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tempfile::TempDir;

fn keeping(url: &str) -> (Trial, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let mut trial = Trial::of(url);
    let cache = Cache::at(folder.path().join("answers"));
    trial.shared.answers = Arc::new(Answers::kept_in(cache));
    (trial, folder)
}

#[test]
fn a_kept_answer_is_the_same_costs_nothing_and_tells_nothing() {
    let provider = Provider::playing(vec![good("first"), good("second")]);
    let (trial, _folder) = keeping(provider.base_url());
    let bought = trial
        .model()
        .ask(&request(), &mut Ledger::unwritten(&Budget::default()))
        .unwrap();
    let mut notes = Notes::new();
    let kept = trial.model().ask(&request(), &mut notes).unwrap();
    assert_eq!((kept.text.as_str(), kept.usage), ("first", bought.usage));
    assert_eq!(kept.cost, Some(Usd::ZERO));
    assert!(notes.told.is_empty());
    assert_eq!(provider.calls(), 1);
}

#[test]
fn whatever_an_answer_depends_on_makes_another_question_of_it() {
    let replies = (0..20).map(|at| good(&at.to_string())).collect();
    let provider = Provider::playing(replies);
    let (trial, _folder) = keeping(provider.base_url());
    let mut texts = Vec::new();
    let mut ask = |trial: &Trial, change: &dyn Fn(&mut Request)| {
        let mut changed = request();
        change(&mut changed);
        texts.push(
            trial
                .model()
                .ask(&changed, &mut Ledger::unwritten(&Budget::default()))
                .unwrap()
                .text,
        );
    };
    ask(&trial, &|_| {});
    ask(&trial, &|request| request.repetition = 1);
    ask(&trial, &|request| request.step = 2);
    ask(&trial, &|request| request.start = Some(0));
    ask(&trial, &|request| request.start = Some(1));
    ask(&trial, &|request| request.candidate = 1);
    ask(&trial, &|request| request.temperature = Some(0.5));
    let other = |change: &dyn Fn(&mut Trial)| {
        let mut other = Trial::of(provider.base_url());
        other.shared = trial.shared.clone();
        change(&mut other);
        other
    };
    ask(
        &other(&|trial| trial.settings.profile.provider.name = "another".to_owned()),
        &|_| {},
    );
    ask(
        &other(&|trial| trial.settings.profile.id = "another".to_owned()),
        &|_| {},
    );
    let base = provider.base_url().replace("/v1", "/v2");
    let base = fab_providers::remote::BaseUrl::parse(&base).unwrap();
    ask(
        &other(&|trial| trial.settings.base_url = base.clone()),
        &|_| {},
    );
    let expected: Vec<String> = (0..10).map(|at| at.to_string()).collect();
    assert_eq!(texts, expected);
    assert_eq!(trial.settings.profile.provider.wire, Wire::OpenaiChat);
}

#[test]
fn a_schema_that_is_refused_is_left_out_from_then_on_and_nothing_is_paid_for_twice() {
    for body in [
        r#"{"error":{"message":"This response_format type is unavailable now"}}"#,
        r#"{"detail":[{"loc":["body","response_format"],"msg":"json_schema is not supported"}]}"#,
    ] {
        let refusal = status(422).json(body);
        let provider = Provider::playing(vec![refusal, good("first"), good("second")]);
        let (mut trial, _folder) = keeping(provider.base_url());
        let told = Arc::new(Mutex::new(Vec::new()));
        let heard = told.clone();
        trial.shared.tell = Arc::new(move |words| heard.lock().unwrap().push(words.to_owned()));
        let asked = |step| Request {
            schema: Some(serde_json::json!({ "type": "object" })),
            step,
            ..request()
        };
        let model = trial.model();
        let (mut first, mut second) = (Notes::new(), Notes::new());
        let replies = [(1, &mut first), (2, &mut second)]
            .map(|(step, notes)| model.ask(&asked(step), notes).unwrap().text);
        assert_eq!(replies, ["first", "second"]);
        assert_eq!(first.faults(), [(Fault::BadRequest, Billing::No)]);
        assert_eq!(second.faults(), []);
        let sent = provider.questions().into_iter();
        let sent: Vec<bool> = sent
            .map(|it| String::from_utf8_lossy(&it.body).contains("response_format"))
            .collect();
        assert_eq!(sent, [true, false, false]);
        let told = told.lock().unwrap();
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(
            told[0].contains("refuses the schema of the answer"),
            "{told:?}"
        );
        // A later run does not know of the refusal, and still finds both answers.
        let later = trial.model();
        let kept = [1, 2].map(|step| {
            later
                .ask(&asked(step), &mut Ledger::unwritten(&Budget::default()))
                .unwrap()
                .text
        });
        assert_eq!(kept, replies);
        assert_eq!(provider.calls(), 3);
        // What is known to take a schema is not asked without one: the message says how.
        trial.settings.profile.facts.structured_output = Some(true);
        let provider = Provider::playing(vec![status(400).json(body)]);
        trial.settings.base_url =
            fab_providers::remote::BaseUrl::parse(provider.base_url()).unwrap();
        let error = trial
            .model()
            .ask(&asked(1), &mut Ledger::unwritten(&Budget::default()))
            .unwrap_err();
        assert!(error.to_string().contains("--omit SETTING"), "{error}");
    }
}

#[test]
fn failures_are_not_kept() {
    let provider = Provider::playing(vec![status(400), good("there")]);
    let (trial, _folder) = keeping(provider.base_url());
    trial
        .model()
        .ask(&request(), &mut Ledger::unwritten(&Budget::default()))
        .unwrap_err();
    let reply = trial
        .model()
        .ask(&request(), &mut Ledger::unwritten(&Budget::default()))
        .unwrap();
    assert_eq!(reply.text, "there");
}

#[test]
fn a_broken_file_costs_a_call_and_no_error() {
    let provider = Provider::playing(vec![good("first"), good("second")]);
    let (trial, folder) = keeping(provider.base_url());
    trial
        .model()
        .ask(&request(), &mut Ledger::unwritten(&Budget::default()))
        .unwrap();
    for entry in fs::read_dir(folder.path().join("answers")).unwrap() {
        fs::write(entry.unwrap().path(), "{\"format\":1,\"text\":").unwrap();
    }
    let reply = trial
        .model()
        .ask(&request(), &mut Ledger::unwritten(&Budget::default()))
        .unwrap();
    assert_eq!(reply.text, "second");
}

#[test]
fn threads_with_one_question_make_one_call() {
    let slow = good("one").delay(Duration::from_millis(200));
    let provider = Provider::playing(vec![slow, good("another")]);
    let (trial, _folder) = keeping(provider.base_url());
    let texts: Vec<String> = std::thread::scope(|scope| {
        let asking = (0..4).map(|_| {
            scope.spawn(|| {
                trial
                    .model()
                    .ask(&request(), &mut Ledger::unwritten(&Budget::default()))
                    .unwrap()
                    .text
            })
        });
        let asking: Vec<_> = asking.collect();
        asking
            .into_iter()
            .map(|thread| thread.join().unwrap())
            .collect()
    });
    assert_eq!(texts, ["one"; 4]);
    assert_eq!(provider.calls(), 1);
}
