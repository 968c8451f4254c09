//! Answers in the form that a schema asks for: as they are, read from words, or refused.

use super::server::{Server, stream};
use super::{CHAT, RESPONSES, changed};
use crate::suite::support::Scripted;
use fab_model::{Message, Speaker};
use fab_standins::{Geometric, Random};
use serde_json::{Value, json};
use std::sync::Arc;

fn action() -> Value {
    json!({
        "type": "object",
        "properties": {
            "pick": { "type": "string", "enum": ["(1, 2)", "(3, 4)"] },
            "place": { "type": "string", "pattern": r"^\((0|-?[1-9][0-9]{0,5}), (0|-?[1-9][0-9]{0,5})\)$" },
            "direction": { "type": "string", "enum": ["0 deg", "45 deg"] },
            "distance": { "type": "string", "enum": ["0.25 edge", "0.5 edge"] },
            "grip": { "type": "string", "enum": ["soft", "firm"] },
            "reason": { "type": "string" },
        },
        "required": ["pick", "place", "direction", "distance", "grip", "reason"],
        "additionalProperties": false,
    })
}

/// A request for an answer that follows a schema.
fn asking(path: &str, schema: Value, is_strict: Value) -> Value {
    let mut described = json!({ "name": "action", "strict": is_strict, "schema": schema });
    if path == CHAT {
        let format = json!({ "type": "json_schema", "json_schema": described });
        return changed(path, "response_format", format);
    }
    described["type"] = json!("json_schema");
    changed(path, "text", json!({ "format": described }))
}

/// The text and the refusal of an answer.
fn content(path: &str, answer: &Value) -> (Value, Value) {
    if path == CHAT {
        let message = &answer["choices"][0]["message"];
        return (message["content"].clone(), message["refusal"].clone());
    }
    let part = &answer["output"][0]["content"][0];
    (part["text"].clone(), part["refusal"].clone())
}

const IN_WORDS: &str = "I fold it over.\nPick Point = (3, 4)\nPlace Point = (50, 60)\nDirection = 45 degrees\n\
                        Distance = 0.5 edge\nGrip = firm";

#[test]
fn an_answer_that_follows_the_schema_goes_out_as_it_is_and_one_in_words_as_json() {
    let said = json!({
        "pick": "(3, 4)", "place": "(50, 60)", "direction": "45 deg", "distance": "0.5 edge", "grip": "firm",
        "reason": IN_WORDS,
    });
    let as_it_is = serde_json::to_string_pretty(&said).unwrap();
    let fenced = format!("Here it is:\n```json\n{said}\n```\n");
    for path in [CHAT, RESPONSES] {
        for strict in [json!(true), json!(false), Value::Null] {
            let server = Server::of(Arc::new(Scripted::new(&[&as_it_is, &fenced, IN_WORDS])));
            for wanted in [as_it_is.clone(), said.to_string(), said.to_string()] {
                let (status, answer) = server.post(path, &asking(path, action(), strict.clone()));
                assert_eq!(status, 200, "{answer}");
                assert_eq!(content(path, &answer), (json!(wanted), Value::Null));
            }
        }
    }
}

#[test]
fn an_answer_without_the_form_of_a_strict_schema_is_refused_and_never_sent_as_if_it_followed() {
    let two_values = format!("{IN_WORDS}\nPick Point = (1, 2)");
    let unlisted = IN_WORDS.replace("(3, 4)", "(3, 5)");
    let thoughts = format!("<think>\n{IN_WORDS}\n</think>\nI cannot decide.");
    for (reply, why) in [
        ("I cannot say.", "it is not JSON"),
        (&two_values, "it is not JSON"),
        (&unlisted, "it is not JSON"),
        (&thoughts, "it is not JSON"),
        (r#"{"pick": "(1, 2)"}"#, "`$` lacks `place`"),
        ("3", "`$` is not of the type \"object\""),
    ] {
        for path in [CHAT, RESPONSES] {
            let model = Arc::new(Scripted::new(&[reply; 4]));
            let server = Server::of(model.clone());
            let strict = asking(path, action(), json!(true));
            let (status, answer) = server.post(path, &strict);
            let (text, refusal) = content(path, &answer);
            assert_eq!((status, text), (200, Value::Null), "{answer}");
            let refusal = refusal.as_str().unwrap();
            assert!(
                refusal.contains(&format!("does not follow the schema: {why}")),
                "{refusal}"
            );
            // Clients send an answer back with their next question.
            let (field, echoed) = match path {
                CHAT => ("messages", answer["choices"][0]["message"].clone()),
                _ => ("input", answer["output"][0].clone()),
            };
            let next = json!([{ "role": "user", "content": "fold it" }, echoed]);
            let (status, _) = server.post(path, &changed(path, field, next));
            let asked = model.asked.lock().unwrap().pop().unwrap();
            assert_eq!(status, 200);
            assert_eq!(
                asked.messages[1],
                Message::text(Speaker::Assistant, refusal)
            );
            let mut body = strict.clone();
            body["stream"] = json!(true);
            let (_, lines) = stream(server.address, path, &body);
            let lines = lines.join("\n");
            let (kind, other) = match path {
                CHAT => (r#""delta":{"refusal":"#, r#""delta":{"content":"#),
                _ => ("event: response.refusal.delta", "response.output_text"),
            };
            assert!(lines.contains(kind) && !lines.contains(other), "{lines}");
            // Without `strict` the schema is a wish.
            let (_, answer) = server.post(path, &asking(path, action(), json!(false)));
            assert_eq!(content(path, &answer), (json!(reply), Value::Null));
        }
    }
}

#[test]
fn stand_ins_answer_in_the_schema_that_they_are_asked_for() {
    let schema = json!({
        "type": "object",
        "properties": {
            "pick": { "type": "string", "enum": ["(60, 60)", "(164, 60)", "(164, 164)", "(60, 164)"] },
            "place": { "type": "string", "enum": ["(60, 60)", "(164, 60)", "(164, 164)", "(60, 164)"] },
        },
        "required": ["pick", "place"],
        "additionalProperties": false,
    });
    let question = "- Method of folding: Pick the top left corner and place it on the bottom right corner\n\
                    - Cloth corners: (60, 60), (164, 60), (164, 164), (60, 164)\n\
                    Pick Point = (x, y)\nPlace Point = (x, y)";
    let models: [Arc<dyn fab_model::Model>; 2] = [Arc::new(Geometric), Arc::new(Random::seeded(3))];
    for model in models {
        let name = model.name().to_owned();
        let server = Server::of(model);
        for path in [CHAT, RESPONSES] {
            let mut body = asking(path, schema.clone(), json!(true));
            body["model"] = json!(name);
            let field = if path == CHAT { "messages" } else { "input" };
            body[field] = json!([{ "role": "user", "content": question }]);
            let (_, answer) = server.post(path, &body);
            let (text, refusal) = content(path, &answer);
            assert_eq!(refusal, Value::Null, "{name}");
            let action: Value = serde_json::from_str(text.as_str().unwrap()).unwrap();
            assert!(
                action["pick"].is_string() && action["place"].is_string(),
                "{action}"
            );
        }
    }
}

#[test]
fn a_schema_that_cannot_be_checked_still_reaches_the_model_unless_it_is_strict() {
    let schema = json!({ "oneOf": [{ "type": "string" }] });
    let model = Arc::new(Scripted::new(&["said"]));
    let server = Server::of(model.clone());
    assert_eq!(
        server
            .post(CHAT, &asking(CHAT, schema.clone(), json!(true)))
            .0,
        400
    );
    let (_, answer) = server.post(CHAT, &asking(CHAT, schema.clone(), json!(false)));
    assert_eq!(content(CHAT, &answer), (json!("said"), Value::Null));
    assert_eq!(model.asked.lock().unwrap()[0].schema, Some(schema));
}
