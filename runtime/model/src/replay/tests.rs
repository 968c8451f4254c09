//! Tests of replays: byte for byte, of several runs, and what is said about a question that was not asked.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::calls::{
    Billing, Budget, Call, CallEnd, CallRefused, FailedCall, Fault, Ledger, Usage, Usd,
};
use crate::{Message, Part, Png, Speaker};
use serde_json::json;

/// A model that is only asked for its name.
struct Shop;

impl Model for Shop {
    fn name(&self) -> &str {
        "shop:model"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::Model
    }

    fn ask(&self, _: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        Err(CallRefused::Interrupted.into())
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
        usage: Some(Usage {
            input_tokens: 9,
            output_tokens: 4,
            ..Usage::default()
        }),
        cost: Some(Usd::from_nano(7)),
        ..Reply::text(text)
    }
}

fn failed() -> FailedCall {
    FailedCall {
        fault: Fault::TimedOut,
        why: "too slow".to_owned(),
        billing: Billing::Possibly,
        cost: None,
        usage: None,
    }
}

/// Writes a question with one call and its end to the ledger of a folder.
fn call(folder: &Path, request: &Request, end: CallEnd<'_>) {
    let budget = Budget::default();
    let mut ledger = Ledger::open(folder, &budget).unwrap();
    ledger.asks(&Shop, request);
    let call = Call {
        model: "shop:model",
        key: &request.key(),
        number: 1,
        at_most: None,
    };
    ledger.begin(&call).unwrap();
    ledger.end(end).unwrap();
}

fn answer(folder: &Path, words: &str, text: &str) {
    call(folder, &request(words), Ok(&bought(text)));
}

/// Replies with characters that a careless writer would change.
const TEXTS: [&str; 3] = ["Pick Point = (1, 2)\r\n", "\u{1F9E6} \\\" \u{0} ende", ""];

fn asked(folder: &Path) -> Replay {
    Replay::load(folder, ModelRole::Vision).unwrap()
}

fn ask(replay: &Replay, request: &Request) -> Result<Reply, ModelError> {
    replay.ask(request, &mut Ledger::unwritten(&Budget::default()))
}

#[test]
fn a_replay_answers_byte_for_byte_and_costs_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    call(folder, &request("again"), Err(&failed()));
    for text in TEXTS {
        answer(folder, &format!("about {text}"), text);
    }
    answer(folder, "again", "at last");
    call(folder, &request("never"), Err(&failed()));
    let replay = asked(folder);
    assert_eq!(replay.name(), "replay(shop:model)");
    assert_eq!(replay.nature(), ModelKind::Model);
    for text in TEXTS {
        let reply = ask(&replay, &request(&format!("about {text}"))).unwrap();
        let free = Reply {
            cost: None,
            ..bought(text)
        };
        assert_eq!(reply, free);
    }
    // Another schema, or none, is the same question.
    for schema in [None, Some(json!({ "properties": { "reason": {} } }))] {
        let again = Request {
            schema,
            ..request("again")
        };
        assert_eq!(ask(&replay, &again).unwrap().text, "at last");
    }
    let error = ask(&replay, &request("never")).unwrap_err();
    let is_timeout = matches!(
        error,
        ModelError::Failed {
            fault: Fault::TimedOut,
            ..
        }
    );
    assert!(is_timeout, "{error}");
    let text = std::fs::read_to_string(folder.join(LEDGER_FILE)).unwrap();
    assert!(!text.contains("AQID"), "a picture stands as its hash");
}

#[test]
fn the_runs_of_a_suite_are_one_replay() {
    let folder = tempfile::tempdir().unwrap();
    for (run, start, text) in [("a/0000", 0, "first"), ("a/0001", 1, "second")] {
        let run = folder.path().join(run);
        std::fs::create_dir_all(&run).unwrap();
        let request = Request {
            start: Some(start),
            ..request("again")
        };
        call(&run, &request, Ok(&bought(text)));
    }
    let replay = asked(folder.path());
    assert!(!replay.shares_answers());
    let at = |start| {
        let request = Request {
            start,
            ..request("again")
        };
        ask(&replay, &request)
    };
    assert_eq!(at(Some(0)).unwrap().text, "first");
    assert_eq!(at(Some(1)).unwrap().text, "second");
    let why = at(Some(2)).unwrap_err().to_string();
    assert!(why.contains("`start` (recorded "), "{why}");
    answer(&folder.path().join("a/0000"), "again", "for all");
    assert_eq!(
        ask(&asked(folder.path()), &request("again")).unwrap().text,
        "for all"
    );
}

#[test]
fn several_models_of_one_role_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for (name, model) in [("a", "shop:model"), ("b", "shop:other")] {
        let run = folder.path().join(name);
        std::fs::create_dir(&run).unwrap();
        answer(&run, "again", "yes");
        let file = run.join(LEDGER_FILE);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text.replace("shop:model", model)).unwrap();
    }
    let refused = Replay::load(folder.path(), ModelRole::Vision).unwrap_err();
    let message = refused.to_string();
    assert!(message.contains("`shop:model`, `shop:other`"), "{message}");
    assert_eq!(asked(&folder.path().join("b")).name(), "replay(shop:other)");
}

#[test]
fn what_holds_no_answers_is_refused_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("notes.jsonl");
    let refused = |path: &Path| Replay::load(path, ModelRole::Text).unwrap_err().to_string();
    let cases = [
        ("my notes\n", "line 1 is damaged"),
        (
            "{\"type\":\"recording\",\"schema\":1}\n",
            "unknown variant `recording`",
        ),
        ("", "it holds no answer from a model"),
    ];
    for (text, why) in cases {
        std::fs::write(&file, text).unwrap();
        let message = refused(&file);
        assert!(
            message.contains("notes.jsonl") && message.contains(why),
            "{message}"
        );
    }
    assert!(refused(folder.path()).contains("no calls.jsonl lies in it"));
    assert!(refused(&folder.path().join("absent")).contains("absent"));
}

#[test]
fn a_question_that_was_not_asked_names_what_changed() {
    let folder = tempfile::tempdir().unwrap();
    answer(folder.path(), "second line", "yes");
    let replay = asked(folder.path());
    type Change = fn(&mut Request);
    let cases: [(Change, &str); 10] = [
        (
            |it| it.temperature = Some(0.7),
            "`temperature` (recorded 0.2, now 0.7)",
        ),
        (
            |it| it.max_tokens = Some(5),
            "`max_tokens` (recorded null, now 5)",
        ),
        (|it| it.repetition = 2, "`repetition` (recorded 0, now 2)"),
        (
            |it| it.candidate = 2,
            "`candidate` (recorded nothing, now 2)",
        ),
        (|it| it.step = 4, "`step` (recorded 1, now 4)"),
        (
            |it| *it = Request::new(ModelRole::Text, Vec::new()),
            "no text model was asked there; name one for that role: `--model text=MODEL`",
        ),
        (
            |it| it.role = ModelRole::Text,
            "`role` (recorded \"vision\", now \"text\")",
        ),
        (
            |it| it.messages = request("another line").messages,
            "`messages[0].parts[0].text`, line 2 (recorded \"second line\", now \"another line\")",
        ),
        (
            |it| it.messages[0].parts[1] = Part::Image(Png::new(vec![4])),
            "`messages[0].parts[1].image` (recorded \"039058c6f2c0",
        ),
        (
            |it| it.messages.push(Message::text(Speaker::Assistant, "x")),
            "`messages[1]` (recorded nothing, now {",
        ),
    ];
    for (change, expected) in cases {
        let mut changed = request("second line");
        change(&mut changed);
        let Err(ModelError::Unsupported { why, .. }) = ask(&replay, &changed) else {
            panic!("{expected}: it was answered, or failed otherwise");
        };
        assert!(why.contains(expected), "{why}\nhas no: {expected}");
    }
}
