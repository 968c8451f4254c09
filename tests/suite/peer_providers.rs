//! The providers' own Python clients parse what fabc would send, and produce what it must parse; `make test-all` runs
//! it.

use super::support::{fabc, finish, project};
use fab_model::{Message, Part, Png, Request, Speaker};
use fab_program::{ModelRole, Reasoning, ReasoningLevel};
use fab_providers::catalogue::MaxTokensField;
use fab_providers::remote::wire::Answer;
use fab_providers::remote::{BaseUrl, Lengths, Settings, Wire};
use fab_standins::Geometric;
use fab_test_provider::{Provider, Question};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Runs one of the script's commands on a folder; returns the number that it prints.
fn script(verb: &str, folder: &Path) -> usize {
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
    let output = Command::new(python)
        .arg(project("tests/peers/validate_requests.py"))
        .arg(verb)
        .arg(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    String::from_utf8(output.stdout)
        .unwrap()
        .trim()
        .parse()
        .unwrap()
}

fn settings(wire: Wire) -> Settings {
    let base = BaseUrl::parse("http://localhost").unwrap();
    let mut settings = Settings::new("provider", "a-model", wire, base);
    settings.profile.facts.structured_output = Some(true);
    settings
}

/// Every form of a request, by name.
fn requests() -> Vec<(&'static str, Request)> {
    let words = Request::new(
        ModelRole::Text,
        vec![Message::text(Speaker::User, "fold it")],
    );
    let with = |change: &dyn Fn(&mut Request)| {
        let mut changed = words.clone();
        change(&mut changed);
        changed
    };
    let picture = fab_picture::png::encode(&image::RgbImage::new(8, 8));
    let shown = Message {
        speaker: Speaker::User,
        parts: vec![
            Part::Text("before and after".to_owned()),
            Part::Image(Png::new(picture.clone())),
            Part::Image(Png::new(picture)),
            Part::Text("what is done?".to_owned()),
        ],
    };
    let program = super::support::task("smoothing");
    let schema = fab_program::reply::static_schema(&program);
    let corrected = |request: &mut Request| {
        request.messages = vec![
            Message::text(Speaker::System, "You fold cloth."),
            shown.clone(),
            Message::text(Speaker::Assistant, "Pick Point = (1, 2)"),
            Message::text(Speaker::User, "that is not on the cloth"),
        ];
    };
    vec![
        ("text", words.clone()),
        (
            "pictures",
            with(&|request| request.messages = vec![shown.clone()]),
        ),
        ("corrections", with(&corrected)),
        (
            "temperature",
            with(&|request| request.temperature = Some(0.2)),
        ),
        ("top_p", with(&|request| request.top_p = Some(1.0))),
        (
            "max_tokens",
            with(&|request| request.max_tokens = Some(769)),
        ),
        (
            "schema",
            with(&|request| request.schema = Some(schema.clone())),
        ),
        (
            "reasoning_none",
            with(&|request| request.reasoning = Some(Reasoning::Level(ReasoningLevel::None))),
        ),
        (
            "reasoning_low",
            with(&|request| request.reasoning = Some(Reasoning::Level(ReasoningLevel::Low))),
        ),
        (
            "reasoning_high",
            with(&|request| {
                request.reasoning = Some(Reasoning::Level(ReasoningLevel::High));
                request.schema = Some(schema.clone());
                request.max_tokens = Some(1000);
            }),
        ),
        (
            "reasoning_tokens",
            with(&|request| request.reasoning = Some(Reasoning::Tokens(2048))),
        ),
        (
            "everything",
            with(&|request| {
                corrected(request);
                request.temperature = Some(0.0);
                request.top_p = Some(0.5);
                request.max_tokens = Some(1000);
                request.schema = Some(schema.clone());
            }),
        ),
    ]
}

#[test]
#[ignore = "needs Python with the providers' clients"]
fn peer_the_providers_own_clients_know_every_field_that_is_sent() {
    let folder = tempfile::tempdir().unwrap();
    let mut count = 0;
    for wire in Wire::ALL {
        for (name, request) in requests() {
            for field in [
                MaxTokensField::MaxTokens,
                MaxTokensField::MaxCompletionTokens,
            ] {
                let mut settings = settings(wire);
                settings.profile.facts.max_tokens_field = Some(field);
                let Ok(encoded) =
                    wire.encode(&request, &settings, Lengths::of(&request, &settings))
                else {
                    let counts = matches!(wire, Wire::Anthropic | Wire::Gemini);
                    assert!(name == "reasoning_tokens" && !counts, "{name}");
                    continue;
                };
                let version = encoded
                    .headers
                    .iter()
                    .map(|(_, version)| format!("-{version}"));
                let place = format!("{}{}", wire.name(), version.collect::<String>());
                let place = folder.path().join(place);
                fs::create_dir_all(&place).unwrap();
                fs::write(place.join(format!("{name}-{field:?}.json")), encoded.body).unwrap();
                count += 1;
            }
        }
    }
    assert_eq!(script("requests", folder.path()), count);
}

#[test]
#[ignore = "needs Python with the providers' clients"]
fn peer_replies_of_the_providers_own_classes_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let written = script("replies", folder.path());
    let mut count = 0;
    for wire in Wire::ALL {
        for entry in fs::read_dir(folder.path().join(wire.name())).unwrap() {
            let path = entry.unwrap().path();
            let name = path.display().to_string();
            let Some(reply) = name.strip_suffix(".expected.json") else {
                continue;
            };
            let expected: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
            let reply = fs::read(format!("{reply}.json")).unwrap();
            let found = match wire.decode(&reply) {
                Ok(Answer { text, usage }) => {
                    let mut found = serde_json::json!(usage.unwrap());
                    found["text"] = text.into();
                    found
                }
                Err(failure) => serde_json::json!({ "fault": failure.fault }),
            };
            assert_eq!(found, expected, "{name}");
            count += 1;
        }
    }
    assert_eq!((count, count > 20), (written, true));
}

/// Returns the messages of a question, with content of one text as a string, and without the default detail of pictures.
fn plain_messages(question: &Question) -> Value {
    let mut messages = question.json()["messages"].take();
    for message in messages.as_array_mut().unwrap() {
        let content = &mut message["content"];
        for part in content.as_array_mut().into_iter().flatten() {
            let picture = part["image_url"].as_object_mut();
            assert!(picture.is_none_or(|picture| {
                let detail = picture.remove("detail");
                detail.is_none_or(|detail| detail == "auto")
            }));
            let fields = part.as_object_mut().unwrap();
            fields.retain(|_, value| !value.is_null());
        }
        let only = content.as_array().filter(|parts| parts.len() == 1);
        if let Some(text) = only.and_then(|parts| parts[0].get("text")).cloned() {
            *content = text;
        }
    }
    messages
}

#[test]
#[ignore = "needs Python with the openai and inspect_ai packages"]
fn peer_the_official_client_and_an_evaluator_send_the_messages_that_fabc_sends() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let task = project("tasks/double_triangle.fab");
    let rendered = finish(fabc(folder).args(["render", &task, "--out", "rendered", "--json"]));
    assert_eq!(rendered.code, 0, "{}", rendered.stderr);
    fs::write(folder.join("rendered.json"), rendered.stdout).unwrap();
    let provider = Provider::of(Geometric);
    let said = finish(fabc(folder).args([
        "run",
        &task,
        "--no-cache",
        "--allow-unknown-price",
        "--max-calls",
        "1",
        "--model",
        "compatible:geometric",
        "--base-url",
        provider.base_url(),
    ]));
    assert_eq!(said.code, 3, "{}", said.stderr);
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
    let output = Command::new(python)
        .current_dir(folder)
        // Nothing but the provider can be reached.
        .envs([
            ("HTTP_PROXY", "http://127.0.0.1:9"),
            ("HTTPS_PROXY", "http://127.0.0.1:9"),
            ("NO_PROXY", "127.0.0.1"),
        ])
        .env("HOME", folder)
        .arg(project("tests/peers/send_messages.py"))
        .args([provider.base_url(), "rendered.json", "rendered"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let questions = provider.questions();
    let [ours, client, evaluator] = &questions[..] else {
        panic!("{} questions", questions.len());
    };
    assert_eq!(plain_messages(client), plain_messages(ours));
    assert_eq!(plain_messages(evaluator), plain_messages(ours));
}
