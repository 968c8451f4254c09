//! Tests of answers that hidden reasoning cuts off, and of parameters that a provider refuses.

use crate::support::*;
use fab_model::calls::{FailedCall, Fault, Usd};
use fab_model::{Model, ModelError, Reasoning, Request};
use fab_program::ReasoningLevel;
use fab_providers::catalogue::Price;
use serde_json::{Value, json};

/// A reply that was cut off after `output` tokens, `hidden` of which cannot be seen.
fn cut(text: &str, output: u64, hidden: Option<u64>) -> Response {
    let details = hidden.map(|tokens| json!({ "reasoning_tokens": tokens }));
    status(200).json(json!({
        "choices": [{ "finish_reason": "length", "message": { "content": text } }],
        "usage": { "prompt_tokens": 10, "completion_tokens": output, "completion_tokens_details": details },
    }))
}

fn asked(reasoning: Option<Reasoning>) -> Request {
    Request {
        max_tokens: Some(100),
        reasoning,
        ..request()
    }
}

fn trial(provider: &Provider) -> Trial {
    let mut trial = Trial::of(provider.base_url());
    // One nano-dollar for each token of the answer.
    trial.settings.price = Some(Price {
        output: 0.001,
        ..Price::FREE
    });
    trial
}

fn bodies(provider: &Provider) -> Vec<Value> {
    let received = provider.questions();
    let bodies = received
        .iter()
        .map(|it| serde_json::from_slice(&it.body).unwrap());
    bodies.collect()
}

fn reserved(notes: &Notes) -> Vec<Option<u64>> {
    let begun = notes.told.iter().filter_map(|told| match told {
        Told::Begin { at_most, .. } => Some(at_most.map(Usd::nano)),
        _ => None,
    });
    begun.collect()
}

#[test]
fn an_answer_cut_off_by_hidden_reasoning_is_asked_for_once_more_with_twice_the_room() {
    for (reasoning, first, hidden, second) in [
        (None, 100, Some(100), 2148),
        (None, 100, None, 2148),
        (
            Some(Reasoning::Level(ReasoningLevel::Low)),
            1124,
            Some(1124),
            2348,
        ),
        (
            Some(Reasoning::Level(ReasoningLevel::High)),
            16_484,
            Some(16_400),
            32_900,
        ),
    ] {
        let provider = Provider::playing(vec![cut("", first, hidden), good("there")]);
        let mut notes = Notes::new();
        let reply = trial(&provider)
            .model()
            .ask(&asked(reasoning), &mut notes)
            .unwrap();
        assert_eq!(reply.text, "there");
        let [one, two] = &bodies(&provider)[..] else {
            panic!("{:?}", provider.calls());
        };
        assert_eq!(
            (&one["max_tokens"], &two["max_tokens"]),
            (&json!(first), &json!(second))
        );
        assert_eq!(one["reasoning_effort"], two["reasoning_effort"]);
        assert_eq!(reserved(&notes), [Some(first), Some(second)]);
        let Told::Failed(FailedCall {
            fault, why, cost, ..
        }) = &notes.ends()[0]
        else {
            panic!("{:?}", notes.told);
        };
        assert_eq!(
            (*fault, *cost),
            (Fault::Truncated, Some(Usd::from_nano(first)))
        );
        let spent = hidden.unwrap_or(first);
        assert!(
            why.contains(&format!("reasoning took {spent} tokens")),
            "{why}"
        );
        assert!(why.contains("100 were allowed for the answer"), "{why}");
    }
}

#[test]
fn a_second_truncation_ends_the_question_and_no_call_is_repeated_as_it_was() {
    let provider = Provider::playing(vec![cut("", 100, Some(100))]);
    let error = trial(&provider)
        .model()
        .ask(&asked(None), &mut Notes::new());
    let Err(ModelError::Failed {
        fault: Fault::Truncated,
        why,
        ..
    }) = error
    else {
        panic!("{error:?}");
    };
    assert!(
        why.contains("after 2 calls") && why.contains("`--reasoning none`"),
        "{why}"
    );
    let bodies = bodies(&provider);
    assert_eq!(bodies.len(), 2);
    assert_ne!(bodies[0], bodies[1]);
}

#[test]
fn an_answer_that_is_too_long_itself_is_not_asked_for_again() {
    for reply in [
        cut("word after word", 100, None),
        cut("word after word", 100, Some(0)),
        cut("word after word", 105, Some(5)),
        cut("", 100, Some(0)),
    ] {
        let provider = Provider::playing(vec![reply]);
        let error = trial(&provider)
            .model()
            .ask(&asked(None), &mut Notes::new());
        let why = error.unwrap_err().to_string();
        assert!(
            why.contains("raise the stage's `tokens`") && why.contains("after 1 call"),
            "{why}"
        );
        assert_eq!(provider.calls(), 1);
    }
}

#[test]
fn without_a_limit_that_could_be_raised_nothing_is_asked_again() {
    let provider = Provider::playing(vec![cut("", 9000, Some(9000))]);
    let unlimited = Request {
        max_tokens: None,
        ..asked(None)
    };
    let trial = Trial::of(provider.base_url());
    let error = trial.model().ask(&unlimited, &mut Notes::new());
    let why = error.unwrap_err().to_string();
    assert!(why.contains("reasoning took 9000 tokens"), "{why}");
    assert_eq!(provider.calls(), 1);
}

#[test]
fn the_larger_call_needs_room_under_the_cap_too() {
    let provider = Provider::playing(vec![cut("", 100, Some(100)), good("there")]);
    let mut notes = Notes {
        allowed: 1,
        ..Notes::new()
    };
    let error = trial(&provider).model().ask(&asked(None), &mut notes);
    assert!(matches!(error, Err(ModelError::NotSent(_))), "{error:?}");
    assert_eq!(provider.calls(), 1);
}

#[test]
fn hidden_tokens_are_reported_beside_the_answers() {
    let mut body = good_body("there");
    body["usage"]["completion_tokens_details"] = json!({ "reasoning_tokens": 3 });
    let provider = Provider::playing(vec![status(200).json(body)]);
    let reply = trial(&provider)
        .model()
        .ask(&asked(None), &mut Notes::new());
    let usage = reply.unwrap().usage.unwrap();
    assert_eq!(
        (
            usage.output_tokens,
            usage.reasoning_tokens,
            usage.visible_tokens()
        ),
        (5, Some(3), 2)
    );
}
