//! Tests of recordings: written, cut off, damaged and replayed.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::calls::{CallRefused, Calls, CapReached, Unrecorded, Usage, Usd};
use crate::{Message, Model, ModelError, ModelKind, ModelRole, Part, Png, Request, Speaker};
use serde_json::json;
use std::time::Duration;

/// A model that is only asked for its name.
struct Silent;

impl Model for Silent {
    fn name(&self) -> &str {
        "silent"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, _: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        Err(failed())
    }
}

fn request(words: &str) -> Request {
    let message = Message {
        speaker: Speaker::User,
        parts: vec![
            Part::Text(format!("first line\n{words}")),
            Part::Image(Png::new(vec![1, 2, 3])),
        ],
    };
    Request {
        temperature: Some(0.2),
        schema: Some(json!({ "properties": { "pick": { "enum": ["(1, 2)"] } } })),
        ..Request::new(ModelRole::Vision, vec![message])
    }
}

fn bought(text: &str) -> Reply {
    Reply {
        text: text.to_owned(),
        usage: Some(Usage {
            input_tokens: 9,
            cached_input_tokens: 0,
            output_tokens: 4,
            reasoning_tokens: Some(1),
        }),
        cost: Some(Usd::from_nano(7)),
    }
}

fn keep(recorder: &Recorder, words: &str, answered: Result<Reply, ModelError>) {
    let took = Duration::from_millis(1500);
    recorder
        .keep(&Silent, &request(words), &answered, took)
        .unwrap();
}

fn failed() -> ModelError {
    ModelError::Failed {
        model: "m".to_owned(),
        fault: Fault::TimedOut,
        why: "too slow".to_owned(),
    }
}

/// Replies with characters that a careless writer would change.
const TEXTS: [&str; 3] = ["Pick Point = (1, 2)\r\n", "\u{1F9E6} \\\" \u{0} ende", ""];

fn recorded(folder: &Path) -> PathBuf {
    let path = folder.join("recording.jsonl");
    let recorder = Recorder::open(&path).unwrap();
    keep(&recorder, "again", Err(failed()));
    for text in TEXTS {
        keep(&recorder, &format!("about {text}"), Ok(bought(text)));
    }
    keep(&recorder, "again", Ok(bought("at last")));
    keep(&recorder, "never", Err(failed()));
    path
}

#[test]
fn a_replay_answers_byte_for_byte_and_costs_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let replay = Replay::load(&recorded(folder.path()), ModelRole::Vision).unwrap();
    assert_eq!(replay.name(), "replay(silent)");
    assert_eq!(replay.nature(), ModelKind::StandIn);
    for text in TEXTS {
        let reply = replay
            .ask(&request(&format!("about {text}")), &mut Unrecorded)
            .unwrap();
        assert_eq!(
            reply,
            Reply {
                cost: None,
                ..bought(text)
            }
        );
    }
    let reply = replay.ask(&request("again"), &mut Unrecorded).unwrap();
    assert_eq!(reply.text, "at last");
    let error = replay.ask(&request("never"), &mut Unrecorded).unwrap_err();
    assert!(
        matches!(
            error,
            ModelError::Failed {
                fault: Fault::TimedOut,
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn a_question_with_another_schema_or_none_has_the_same_answer() {
    let folder = tempfile::tempdir().unwrap();
    let replay = Replay::load(&recorded(folder.path()), ModelRole::Vision).unwrap();
    for schema in [None, Some(json!({ "properties": { "reason": {} } }))] {
        let asked = Request {
            schema,
            ..request("again")
        };
        let reply = replay.ask(&asked, &mut Unrecorded).unwrap();
        assert_eq!(reply.text, "at last");
    }
}

#[test]
fn a_recording_tells_whether_it_was_made_for_each_start() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path());
    assert!(
        Replay::load(&path, ModelRole::Vision)
            .unwrap()
            .shares_answers()
    );
    let recorder = Recorder::open(&path).unwrap();
    for (start, text) in [(0, "first"), (1, "second")] {
        let asked = Request {
            start: Some(start),
            ..request("again")
        };
        recorder
            .keep(&Silent, &asked, &Ok(bought(text)), Duration::ZERO)
            .unwrap();
    }
    let replay = Replay::load(&path, ModelRole::Vision).unwrap();
    assert!(!replay.shares_answers());
    let ask = |start| {
        let asked = Request {
            start,
            ..request("again")
        };
        replay.ask(&asked, &mut Unrecorded)
    };
    let texts = [None, Some(0), Some(1)].map(|start| ask(start).unwrap().text);
    assert_eq!(texts, ["at last", "first", "second"]);
    let why = ask(Some(2)).unwrap_err().to_string();
    assert!(why.contains("`start` (recorded "), "{why}");
}

#[test]
fn nothing_is_recorded_twice_and_what_was_never_sent_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path());
    let before = std::fs::read(&path).unwrap();
    let recorder = Recorder::open(&path).unwrap();
    keep(&recorder, "again", Ok(bought("something else")));
    keep(&recorder, "again", Err(failed()));
    keep(
        &recorder,
        "capped",
        Err(CallRefused::Budget(CapReached {
            why: "no".to_owned(),
            raise: None,
        })
        .into()),
    );
    keep(&recorder, "stopped", Err(ModelError::Interrupted));
    assert_eq!(std::fs::read(&path).unwrap(), before);
    assert!(
        !String::from_utf8(before).unwrap().contains("AQID"),
        "a picture stands as its hash"
    );
}

#[test]
#[ignore = "long"]
fn a_recording_cut_off_at_any_byte_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = recorded(folder.path());
    let whole = std::fs::read(&path).unwrap();
    let cuts = (0..whole.len())
        .step_by(7)
        .chain([whole.len() - 1, whole.len()]);
    for length in cuts {
        std::fs::write(&path, &whole[..length]).unwrap();
        let before = read(&path).unwrap().exchanges;
        keep(
            &Recorder::open(&path).unwrap(),
            "later",
            Ok(bought("later")),
        );
        let after = read(&path).unwrap().exchanges;
        assert_eq!(after[..before.len()], before, "cut at {length}");
        assert_eq!(after.len(), before.len() + 1, "cut at {length}");
    }
}

#[test]
fn a_recording_that_is_being_written_is_not_written_by_another() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.jsonl");
    let first = Recorder::open(&path).unwrap();
    let refused = Recorder::open(&path).unwrap_err().to_string();
    assert!(refused.contains("another fabc is writing it"), "{refused}");
    drop(first);
    assert!(Recorder::open(&path).is_ok());
}

#[test]
fn what_is_no_recording_is_refused_and_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("notes.txt");
    let first = "{\"type\":\"recording\",\"schema\":1,\"fabc\":\"0\"}\n";
    let cases = [
        ("my notes\n".to_owned(), "it does not begin as a recording"),
        (
            "{\"type\":\"recording\",\"schema\":9,\"fabc\":\"7\"}\n".to_owned(),
            "version 9",
        ),
        (format!("{first}{first}"), "line 2 begins another"),
        (format!("{first}{{}}\n"), "line 2 is damaged"),
    ];
    for (text, why) in cases {
        std::fs::write(&path, &text).unwrap();
        for error in [
            Recorder::open(&path).unwrap_err(),
            Replay::load(&path, ModelRole::Text).unwrap_err(),
        ] {
            let said = error.to_string();
            assert!(said.contains("notes.txt") && said.contains(why), "{said}");
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    }
    std::fs::write(&path, first).unwrap();
    let said = Replay::load(&path, ModelRole::Text)
        .unwrap_err()
        .to_string();
    assert!(said.contains("holds no exchange"), "{said}");
    assert!(Replay::load(folder.path(), ModelRole::Text).is_err());
    assert!(Replay::load(&folder.path().join("absent"), ModelRole::Text).is_err());
}

#[test]
fn a_question_that_was_not_recorded_names_what_changed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("one.jsonl");
    let recorder = Recorder::open(&path).unwrap();
    keep(&recorder, "second line", Ok(bought("yes")));
    let replay = Replay::load(&path, ModelRole::Text).unwrap();
    type Change = fn(&mut Request);
    let differs = |change: Change| {
        let mut changed = request("second line");
        change(&mut changed);
        match replay.ask(&changed, &mut Unrecorded) {
            Err(ModelError::Unsupported { why, .. }) => why,
            other => panic!("{other:?}"),
        }
    };
    let cases: [(Change, &str); 9] = [
        (
            |it| it.temperature = Some(0.7),
            "`temperature` (recorded 0.2, now 0.7)",
        ),
        (
            |it| it.max_tokens = Some(5),
            "`max_tokens` (recorded null, now 5)",
        ),
        (|it| it.repetition = 2, "`repetition` (recorded 0, now 2)"),
        (|it| it.candidate = 2, "`candidate` (recorded null, now 2)"),
        (|it| it.step = 4, "`step` (recorded 1, now 4)"),
        (|it| it.role = ModelRole::Text, "`role`"),
        (
            |it| it.messages = request("another line").messages,
            "message 1 (user), part 1, line 2 (recorded `second line`, now `another line`)",
        ),
        (
            |it| it.messages[0].parts[1] = Part::Image(Png::new(vec![4])),
            "message 1 (user), part 2, the picture (recorded 039058c6f2c0",
        ),
        (
            |it| it.messages.push(Message::text(Speaker::Assistant, "x")),
            "the number of messages (recorded 1, now 2)",
        ),
    ];
    for (change, expected) in cases {
        let said = differs(change);
        assert!(said.contains(expected), "{said}\nhas no: {expected}");
        assert_eq!(
            said.matches("; ").count(),
            0,
            "one change is one difference: {said}"
        );
    }
}
