//! Answers as streams of events: every piece in order, and the same answer as without a stream.

use super::server::{Server, stream};
use super::{CHAT, RESPONSES, changed};
use crate::suite::support::Scripted;
use serde_json::{Value, json};
use std::sync::Arc;

const ANSWER: &str = "Pick the corner: \"(41, 167)\" \n\u{85}\u{2028}\u{2029} fold 🧦🧦🧦 över";

/// Asks once without a stream, and once with one; returns the answer, the head, and the named events.
fn both(path: &str, mut body: Value) -> (Value, String, Vec<(Option<String>, String)>) {
    let server = Server::of(Arc::new(Scripted::new(&[ANSWER; 2])));
    let (status, whole) = server.post(path, &body);
    assert_eq!(status, 200, "{whole}");
    body["stream"] = json!(true);
    let (head, lines) = stream(server.address, path, &body);
    let mut events = Vec::new();
    let mut name = None;
    for line in lines {
        match line.split_once(": ") {
            Some(("event", value)) => name = Some(value.to_owned()),
            Some(("data", value)) => events.push((name.take(), value.to_owned())),
            _ => assert_eq!(line, ""),
        }
    }
    (whole, head, events)
}

fn parsed(events: &[(Option<String>, String)]) -> Vec<Value> {
    let events = events.iter();
    events
        .map(|(_, data)| {
            assert!(!data.contains(['\u{85}', '\u{2028}', '\u{2029}']), "{data}");
            serde_json::from_str(data).unwrap()
        })
        .collect()
}

fn joined(events: &[Value], of: impl Fn(&Value) -> Option<&str>) -> String {
    events.iter().filter_map(of).collect()
}

#[test]
fn a_completion_streams_in_chunks_that_add_up_to_it() {
    let (whole, head, events) = both(CHAT, changed(CHAT, "user", json!("me")));
    assert!(head.starts_with("HTTP/1.0 200"), "{head}");
    assert!(head.contains("content-type: text/event-stream"), "{head}");
    let (end, events) = events.split_last().unwrap();
    assert_eq!(*end, (None, "[DONE]".to_owned()));
    let chunks = parsed(events);
    for chunk in &chunks {
        assert_eq!(
            (&chunk["id"], &chunk["object"], chunk.get("usage")),
            (&whole["id"], &json!("chat.completion.chunk"), None)
        );
    }
    let text = joined(&chunks, |chunk| {
        chunk["choices"][0]["delta"]["content"].as_str()
    });
    assert_eq!(whole["choices"][0]["message"]["content"], text);
    assert_eq!(chunks[0]["choices"][0]["delta"]["role"], "assistant");
    let ends: Vec<&Value> = chunks
        .iter()
        .map(|it| &it["choices"][0]["finish_reason"])
        .collect();
    let (last, others) = ends.split_last().unwrap();
    assert_eq!(**last, "stop");
    assert!(
        others.len() > 3 && others.iter().all(|end| end.is_null()),
        "{ends:?}"
    );
}

#[test]
fn a_stream_ends_with_its_token_counts_if_they_are_asked_for() {
    let mut body = changed(CHAT, "user", json!("me"));
    body["stream_options"] = json!({ "include_usage": true, "include_obfuscation": false });
    body["stream"] = json!(true);
    let server = Server::of(Arc::new(Scripted::new(&[ANSWER; 2])));
    let (_, lines) = stream(server.address, CHAT, &body);
    let data = lines.iter().filter_map(|line| line.strip_prefix("data: {"));
    let chunks: Vec<Value> = data
        .map(|rest| serde_json::from_str(&format!("{{{rest}")).unwrap())
        .collect();
    let (last, others) = chunks.split_last().unwrap();
    assert_eq!(last["choices"], json!([]));
    let whole = server.post(CHAT, &changed(CHAT, "user", json!("me"))).1;
    assert_eq!(last["usage"], whole["usage"]);
    assert!(
        others
            .iter()
            .all(|chunk| chunk.get("usage") == Some(&Value::Null))
    );
}

#[test]
fn a_response_streams_as_numbered_events_that_add_up_to_it() {
    let (whole, head, events) = both(RESPONSES, changed(RESPONSES, "user", json!("me")));
    assert!(head.contains("content-type: text/event-stream"), "{head}");
    let values = parsed(&events);
    for (number, ((name, _), value)) in events.iter().zip(&values).enumerate() {
        assert_eq!(value["type"].as_str(), name.as_deref());
        assert_eq!(value["sequence_number"], number);
    }
    let mut names: Vec<&str> = values.iter().filter_map(|it| it["type"].as_str()).collect();
    names.dedup();
    assert_eq!(
        names,
        [
            "response.created",
            "response.in_progress",
            "response.output_item.added",
            "response.content_part.added",
            "response.output_text.delta",
            "response.output_text.done",
            "response.content_part.done",
            "response.output_item.done",
            "response.completed",
        ]
    );
    let text = joined(&values, |event| event["delta"].as_str());
    let item = &whole["output"][0];
    assert_eq!(item["content"][0]["text"], text);
    let [.., text_done, part_done, item_done, completed] = values.as_slice() else {
        panic!("{values:?}")
    };
    assert_eq!(
        (&text_done["text"], &text_done["item_id"]),
        (&json!(text), &item["id"])
    );
    assert_eq!(part_done["part"], item["content"][0]);
    assert_eq!((&item_done["item"], &completed["response"]), (item, &whole));
    assert_eq!(values[0]["response"]["output"], json!([]));
}

#[test]
fn the_limit_of_tokens_cuts_an_answer_and_says_so() {
    // By the estimate of four letters a token, ten tokens of eleven.
    let reply = "a".repeat(41);
    for (path, field) in [
        (CHAT, "max_tokens"),
        (CHAT, "max_completion_tokens"),
        (RESPONSES, "max_output_tokens"),
    ] {
        let server = Server::of(Arc::new(Scripted::new(&[reply.as_str(); 3])));
        let (_, whole) = server.post(path, &changed(path, field, json!(11)));
        let (_, cut) = server.post(path, &changed(path, field, json!(10)));
        let mut body = changed(path, field, json!(10));
        body["stream"] = json!(true);
        let (_, lines) = stream(server.address, path, &body);
        let streamed = lines.join("\n");
        if path == CHAT {
            assert_eq!(whole["choices"][0]["finish_reason"], "stop");
            assert_eq!(cut["choices"][0]["finish_reason"], "length");
            assert_eq!(cut["choices"][0]["message"]["content"], "a".repeat(37));
            assert_eq!(cut["usage"]["completion_tokens"], 10);
            assert!(
                streamed.contains(r#""finish_reason":"length""#),
                "{streamed}"
            );
        } else {
            assert_eq!(whole["status"], "completed");
            let (status, why) = (&cut["status"], &cut["incomplete_details"]["reason"]);
            assert_eq!(
                (status, why),
                (&json!("incomplete"), &json!("max_output_tokens"))
            );
            assert_eq!(cut["output"][0]["content"][0]["text"], "a".repeat(37));
            assert_eq!(cut["usage"]["output_tokens"], 10);
            assert!(
                streamed.contains("event: response.incomplete"),
                "{streamed}"
            );
        }
    }
}

#[test]
fn a_model_that_fails_before_a_stream_begins_is_reported_by_its_status() {
    let server = Server::of(Arc::new(Scripted::new(&[])));
    for path in [CHAT, RESPONSES] {
        let (head, body) = stream(server.address, path, &changed(path, "stream", json!(true)));
        assert!(head.starts_with("HTTP/1.0 400"), "{head}");
        assert!(body.concat().contains("the script is over"), "{body:?}");
    }
}
