//! Tests that a key echoed by the server never appears again.

use crate::support::*;
use fab_model::calls::{Budget, Ledger, Usd};
use fab_model::{Model, Reply};
use fab_providers::remote::{Answers, Key, Wire};
use serde_json::{Value, json};
use std::sync::Arc;

const OTHER: &str = "another-canary-key-0123";

/// Fails if a text contains the keys, or pieces of them.
fn check(text: &str) {
    let text = &text.to_lowercase();
    for part in [CANARY, OTHER, "0123456789", "canary"] {
        assert!(!text.contains(part), "`{part}` in: {text}");
    }
}

/// Bodies in which the server echoes the keys.
fn bodies() -> Vec<String> {
    let forms = [
        CANARY.to_owned(),
        format!("{}{CANARY}", "x".repeat(390)),
        OTHER.to_owned(),
    ];
    let chat = |text: &str, end: &str| {
        format!(
            r#"{{"choices":[{{"finish_reason":"{end}","message":{{"content":"{text}","refusal":null}}}}]}}"#
        )
    };
    let of = |text: &String| {
        [
            format!(
                r#"{{"error":{{"message":"wrong key {text}","code":"{text}","type":"{text}"}}}}"#
            ),
            format!("<p>{text}</p>"),
            chat(&format!("your key is {text}"), "stop"),
            chat(text, "length"),
            format!(r#"{{"choices":[{{"message":{{"refusal":"{text}"}}}}]}}"#),
            format!(r#"{{"choices":[{{"message":{{"reasoning_content":"{text}"}}}}]}}"#),
            format!(
                r#"{{"status":"{text}","output":[{{"type":"message","content":[{{"type":"refusal","refusal":"{text}"}}]}}]}}"#
            ),
            format!(r#"{{"content":[{{"type":"text","text":"{text}"}}],"stop_reason":"{text}"}}"#),
            format!(
                r#"{{"content":[{{"type":"text","text":"{text}"}}],"stop_reason":"end_turn"}}"#
            ),
            format!(r#"{{"candidates":[{{"finishReason":"{text}","finishMessage":"{text}"}}]}}"#),
            format!(r#"{{"candidates":[{{"content":{{"parts":[{{"text":"{text}"}}]}}}}]}}"#),
        ]
    };
    forms.iter().flat_map(of).collect()
}

#[test]
#[ignore = "long"]
fn no_error_reply_or_note_holds_a_key_that_the_server_gives_back() {
    let replies = bodies().into_iter().flat_map(|body| {
        [200, 302, 400, 401, 429, 500].map(|code| {
            status(code)
                .json(&body)
                .header("x-echo", CANARY)
                .header("retry-after", CANARY)
                .header("location", format!("http://127.0.0.1:1/{CANARY}"))
        })
    });
    let replies: Vec<Response> = replies.collect();
    for wire in Wire::ALL {
        let provider = Provider::playing(replies.clone());
        let mut trial = Trial::of(provider.base_url());
        trial.settings.profile.provider.wire = wire;
        trial.settings.retry.calls = 1;
        trial.shared.hidden = vec![Key::new("OTHER", OTHER).unwrap()];
        let model = trial.model();
        let mut understood = 0;
        for _ in &replies {
            let mut notes = Notes::new();
            match model.ask(&request(), &mut notes) {
                Ok(reply) => {
                    understood += 1;
                    assert!(reply.text.contains("[key]"), "{reply:?}");
                    check(&format!("{reply:?}"));
                }
                Err(error) => check(&format!("{error} {error:?}")),
            }
            check(&format!("{:?}", notes.told));
        }
        check(&format!("{:?} {:?}", trial.settings, trial.shared.hidden));
        assert_eq!(provider.calls(), replies.len());
        let expected = match wire {
            Wire::OpenaiChat | Wire::Gemini => 3,
            // In one body more the end is an unknown word, and a text is read whatever its end is called.
            Wire::Anthropic => 6,
            // Responses echo the keys only in refusals.
            Wire::OpenaiResponses => 0,
        };
        assert_eq!(understood, expected, "{wire:?}");
    }
}

/// A reply whose text is split into pieces.
fn in_pieces(wire: Wire, pieces: &[&str]) -> Value {
    let typed = |kind: &str| -> Vec<Value> {
        let pieces = pieces.iter();
        pieces
            .map(|text| json!({ "type": kind, "text": text }))
            .collect()
    };
    match wire {
        Wire::OpenaiChat => {
            let message = json!({ "content": typed("text") });
            json!({ "choices": [{ "finish_reason": "stop", "message": message }] })
        }
        Wire::OpenaiResponses => {
            let message = json!({ "type": "message", "content": typed("output_text") });
            json!({ "status": "completed", "output": [message] })
        }
        Wire::Anthropic => json!({ "stop_reason": "end_turn", "content": typed("text") }),
        Wire::Gemini => {
            let content = json!({ "parts": typed("text") });
            json!({ "candidates": [{ "finishReason": "STOP", "content": content }] })
        }
    }
}

#[test]
#[ignore = "long"]
fn a_key_that_the_server_splits_over_pieces_of_text_is_hidden_in_every_wire() {
    for wire in Wire::ALL {
        for at in [1, 8, 15, CANARY.len() - 1] {
            let (one, other) = CANARY.split_at(at);
            let pieces = ["it is <", one, other, ">"];
            let reply = status(200).json(in_pieces(wire, &pieces));
            let provider = Provider::playing(vec![reply]);
            let folder = tempfile::tempdir().unwrap();
            let cache = fab_base::cache::Cache::at(folder.path().to_owned());
            let mut trial = Trial::of(provider.base_url());
            trial.settings.profile.provider.wire = wire;
            trial.shared.answers = Arc::new(Answers::kept_in(cache));
            let mut notes = Notes::new();
            let reply = trial.model().ask(&request(), &mut notes).unwrap();
            assert!(reply.text.starts_with("it is <[key]"), "{reply:?}");
            check(&format!("{reply:?} {:?}", notes.told));
            let mut kept = 0;
            for entry in std::fs::read_dir(folder.path()).unwrap() {
                check(&std::fs::read_to_string(entry.unwrap().path()).unwrap());
                kept += 1;
            }
            assert!(kept > 0, "the answer is kept");
        }
    }
}

#[test]
fn no_kept_answer_holds_a_key() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::playing(vec![good(&format!("it is {CANARY}"))]);
    let mut trial = Trial::of(provider.base_url());
    let cache = fab_base::cache::Cache::at(folder.path().to_owned());
    trial.shared.answers = Arc::new(Answers::kept_in(cache));
    let reply: Reply = trial
        .model()
        .ask(&request(), &mut Ledger::unwritten(&Budget::default()))
        .unwrap();
    assert_eq!(
        (reply.text.as_str(), reply.cost),
        ("it is [key]", Some(Usd::from_nano(150)))
    );
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        check(&std::fs::read_to_string(entry.unwrap().path()).unwrap());
    }
}

#[test]
fn no_panic_message_holds_a_key() {
    /// Panics with everything that it can see of a call.
    struct Panics;
    impl fab_model::calls::Calls for Panics {
        fn begin(
            &mut self,
            call: &fab_model::calls::Call<'_>,
        ) -> Result<(), fab_model::calls::CallRefused> {
            panic!("{call:?}");
        }
        fn end(
            &mut self,
            _: fab_model::calls::CallEnd<'_>,
        ) -> Result<(), fab_model::calls::CallRefused> {
            Ok(())
        }
    }
    let provider = Provider::playing(vec![good("there")]);
    let trial = Trial::of(provider.base_url());
    let model = trial.model();
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        let _ = model.ask(&request(), &mut Panics);
    }));
    let message = caught.unwrap_err();
    let text = message
        .downcast_ref::<String>()
        .cloned()
        .unwrap_or_default();
    assert!(text.contains("a-model"), "{text}");
    check(&text);
    // The gate and the claim were released despite the panic.
    assert!(
        model
            .ask(&request(), &mut Ledger::unwritten(&Budget::default()))
            .is_ok()
    );
}

#[test]
fn a_key_within_the_base_url_is_refused_before_anything_is_sent() {
    let trial = Trial::of(&format!("http://127.0.0.1:1/{OTHER}/v1"));
    let mut shared = trial.shared.clone();
    shared.hidden = vec![Key::new("OTHER", OTHER).unwrap()];
    let error = fab_providers::remote::Remote::new(trial.settings, shared);
    let error = error.err().unwrap();
    check(&format!("{error} {error:?}"));
    assert!(error.to_string().contains("key"), "{error}");
}
